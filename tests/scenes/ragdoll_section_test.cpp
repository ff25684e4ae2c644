// Ragdolls, joints and groups of a scene: as they are loaded, and that the joints hold in a run.
#include "scenes/runner.h"
#include "tests/scenes/scene_fixture.h"

namespace lodestone::ragdoll_section_test {
namespace {

using Joints = SceneFixture;

const char* const kDollAndDoor = R"(version: 1
step: {dt_s: 0.01, steps: 100, full_substeps: 2}
shapes: {door: {box_m: [0.8, 0.1, 0.8]}, crate: {box_m: [0.2, 0.2, 0.2]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
ragdolls:
  - {position_m: [0, 0, 0.3], height_m: 3.08, velocity_m_per_s: [1, 0, 0], name: doll}
  - {position_m: [9, 0, 0.3], orientation: [0, 0, 0, 1]}
bodies:
  - {shape: door, name: door, position_m: [4, 0, 2], angular_velocity_rad_per_s: [0, 0, 1], velocity_m_per_s: [0, 0.4, 0]}
  - {shape: crate, name: lamp, position_m: [4, 3, 2], level: full}
  - {shape: crate, name: chain, position_m: [4, 3, 2.3]}
joints:
  - {hinge: [door], at_m: [3.6, 0, 2], axis: [0, 0, 2]}
  - {ball: [lamp, chain], at_m: [4, 3, 2.15]}
  - {ball: [chain], at_m: [4, 3, 2.4]}
)";

TEST_F(Joints, RagdollsComeFirstWithTheirJointsAndGroups) {
  const Scene scene = load(kDollAndDoor);
  ASSERT_EQ(scene.bodies.size(), 15u);
  EXPECT_EQ(scene.bodies[0].name, "doll torso");
  EXPECT_EQ(scene.bodies[7].name, "ragdoll[1] head");
  EXPECT_EQ(scene.bodies[12].name, "door");
  EXPECT_TRUE(scene.bodies[1].definition.state.position.isApprox(Vec3(0, 0, 0.3 + 2 * 1.43)));
  EXPECT_TRUE(scene.bodies[8].definition.state.position.isApprox(Vec3(9, -0.26, 0.3 + 0.98)))
      << "the left arm of the one that is turned round";
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(scene.bodies[std::size_t(i)].definition.state.velocity, Vec3(1, 0, 0));
  for (const SceneBody& body : scene.bodies) EXPECT_EQ(body.definition.level, LevelChoice::full) << body.name;
  EXPECT_EQ(scene.groups, (std::vector<std::vector<int>>{{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}}));
  ASSERT_EQ(scene.joints.size(), 13u);
  EXPECT_EQ(scene.joints[10].kind, JointKind::hinge);
  EXPECT_EQ(scene.joints[10].first, 12);
  EXPECT_EQ(scene.joints[10].second, SceneJoint::kWorld);
  EXPECT_EQ(scene.joints[10].axis, Vec3::UnitZ());
  EXPECT_EQ(scene.joints[11].second, 14);
}

// As of other bodies: with its line, before anything runs.
TEST_F(Joints, ARagdollsMaterialMayBeTooLight) {
  const std::string error = error_of(R"(version: 1
materials: {feather: {density_kg_per_m3: 1.0e-30}}
ragdolls:
  - {position_m: [0, 0, 0]}
  - {position_m: [3, 0, 0], material: feather}
bodies: []
)");
  EXPECT_NE(error.find(":5: ragdolls[1]: found 4.1"), std::string::npos) << error;
}

// The bodies of a joint see its anchor at the same place, after a second of falling, swinging and hanging.
TEST_F(Joints, Hold) {
  const Scene scene = load(kDollAndDoor);
  const RunResult result = run_scene(scene, {.level = LevelChoice::support});
  EXPECT_EQ(result.last().full, 15) << "whatever level is forced on the others";
  const auto now = [&](int body, const Vec3& at_start) {
    const RigidState &from = scene.bodies[std::size_t(body)].definition.state,
                     &to = result.states[std::size_t(body)];
    return Vec3(to.position + to.orientation * (from.orientation.conjugate() * (at_start - from.position)));
  };
  for (const SceneJoint& joint : scene.joints) {
    const Vec3 other =
        joint.second == SceneJoint::kWorld ? joint.anchor_m : now(joint.second, joint.anchor_m);
    EXPECT_LT((now(joint.first, joint.anchor_m) - other).norm(), 0.01)
        << scene.bodies[std::size_t(joint.first)].name;
  }
  EXPECT_NEAR(result.states[12].position.z(), 2.0, 0.005) << "the door hangs";
  EXPECT_GT(std::abs(result.states[12].position.y()), 0.2) << "and has swung";
  EXPECT_GT((result.states[0].position - scene.bodies[0].definition.state.position).norm(), 0.2)
      << "the ragdoll fell";
}

// Of two crates in the air the one that sleeps stays there.
TEST_F(Joints, ABodyThatStartsAsleepStays) {
  const Scene scene = load(R"(version: 1
shapes: {crate: {box_m: [0.2, 0.2, 0.2]}}
bodies: [{shape: crate, position_m: [0, 0, 5], level: full, asleep: true}, {shape: crate, position_m: [2, 0, 5], level: full}]
)");
  const RunResult result = run_scene(scene, {.steps = 30});
  EXPECT_EQ(result.states[0].position, Vec3(0, 0, 5));
  EXPECT_LT(result.states[1].position.z(), 4.0);
}

TEST_F(Joints, ARecordingKnowsNothingOfThem) {
  const Scene scene = load(kDollAndDoor);
  EXPECT_THROW(run_scene(scene, {.steps = 1, .record = folder() / "r"}), InputError);
}

TEST_F(Joints, Errors) {
  const std::string start =
      "version: 1\nshapes: {a: {box_m: [1, 1, 1]}}\nbodies: [{shape: a, name: one, position_m: [0, 0, 0]}, "
      "{shape: a, name: two, position_m: [0, 0, 2]},\n"
      "  {shape: a, name: two, position_m: [0, 0, 4]}, {shape: a, name: far, position_m: [0, 0, 9], level: "
      "support}]\n";
  const std::pair<const char*, const char*> cases[] = {
      {"joints: [{ball: [one, tree], at_m: [0, 0, 0]}]",
       "s.yaml:5: joints[0].ball[1]: found tree, expected the name of a body"},
      {"joints: [{ball: [one, two], at_m: [0, 0, 0]}]",
       "s.yaml:5: joints[0].ball[1]: found two, which several bodies are called, expected"},
      {"joints: [{ball: [one, far], at_m: [0, 0, 0]}]",
       "s.yaml:5: joints[0].ball[1]: found far, whose level is support, expected"},
      {"joints: [{ball: [one, one], at_m: [0, 0, 0]}]",
       "s.yaml:5: joints[0].ball[1]: found one a second time, expected another body"},
      {"joints: [{ball: [], at_m: [0, 0, 0]}]",
       "s.yaml:5: joints[0].ball: found a list of 0, expected the names of two bodies"},
      {"joints: [{ball: [one]}]", "s.yaml:5: joints[0].at_m: found no such key"},
      {"joints: [{hinge: [one], at_m: [0, 0, 0]}]", "s.yaml:5: joints[0].axis: found no such key"},
      {"joints: [{ball: [one], at_m: [0, 0, 0], axis: [0, 0, 1]}]",
       "s.yaml:5: joints[0].axis: found the axis of a ball joint, expected none"},
      {"joints: [{hinge: [one], at_m: [0, 0, 0], axis: [0, 0, 0]}]",
       "s.yaml:5: joints[0].axis: found [0, 0, 0], expected a direction"},
      {"ragdolls: [{name: x}]", "s.yaml:5: ragdolls[0].position_m: found no such key"},
      {"ragdolls: [{position_m: [0, 0, 0], height: 2}]",
       "s.yaml:5: ragdolls[0].height: found an unknown key"},
      {"ragdolls: [{position_m: [0, 0, 0], height_m: 0}]",
       "s.yaml:5: ragdolls[0].height_m: found 0, expected"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_TRUE(error_of(start + text).starts_with(message)) << error_of(start + text) << "\n" << message;
}

}  // namespace
}  // namespace lodestone::ragdoll_section_test
