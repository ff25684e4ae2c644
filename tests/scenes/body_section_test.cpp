#include <gtest/gtest.h>

#include "tests/scenes/scene_sections.h"

namespace lodestone {
namespace {

class BodySection : public SceneFixture {
 protected:
  std::vector<SceneBody> made(const std::string& bodies, const SceneLoadSettings& settings = {}) const {
    return load(testing::scene_of("bodies: [" + bodies + "]\n"), settings).bodies;
  }
  std::string fault(const std::string& bodies, const SceneLoadSettings& settings = {}) const {
    return error_of(testing::scene_of("bodies: [" + bodies + "]\n"), settings);
  }
};

TEST_F(BodySection, MotionAndNameArrive) {
  const SceneBody body =
      made(
          "{shape: crate, position_m: [1, 2, 3], orientation: [0, 0, 0, 5], velocity_m_per_s: [4, 5, 6], "
          "angular_velocity_rad_per_s: [7, 8, 9], name: hero, importance: 2}")
          .at(0);
  EXPECT_EQ(body.definition.state.position, Vec3(1, 2, 3));
  EXPECT_EQ(body.definition.state.orientation.z(), 1.0);
  EXPECT_EQ(body.definition.state.velocity, Vec3(4, 5, 6));
  EXPECT_EQ(body.definition.state.angular_velocity, Vec3(7, 8, 9));
  EXPECT_EQ(body.name, "hero");
  EXPECT_EQ(body.definition.importance, 2.0);
  EXPECT_FALSE(body.asleep);
}

// The body's own mass goes before its shape's, which goes before the material's.
TEST_F(BodySection, TheNearestMassCounts) {
  const Scene scene = load(testing::scene_of(
      "shapes: {heavy: {sphere_m: 0.5, mass_kg: 7}, plain: {sphere_m: 0.5}}\n"
      "bodies: [{shape: heavy, position_m: [0, 0, 5]}, {shape: heavy, position_m: [2, 0, 5], mass_kg: 3},"
      " {shape: plain, position_m: [4, 0, 5]}]\n"));
  EXPECT_EQ(scene.bodies[0].definition.mass, 7.0);
  EXPECT_EQ(scene.bodies[1].definition.mass, 3.0);
  EXPECT_FALSE(scene.bodies[2].definition.mass);
}

TEST_F(BodySection, RungsAreARange) {
  const SceneBody body =
      made("{shape: ball, position_m: [0, 0, 5], least_rung: support, greatest_rung: full}").at(0);
  EXPECT_EQ(body.definition.least_rung, Rung::support);
  EXPECT_EQ(body.definition.greatest_rung, Rung::full);
  EXPECT_NE(fault("{shape: ball, position_m: [0, 0, 5], least_rung: full, greatest_rung: tables}")
                .find("expected at least least_rung (full)"),
            std::string::npos);
  EXPECT_NE(fault("{shape: ball, position_m: [0, 0, 5], level: ful}").find("did you mean \"full\"?"),
            std::string::npos);
}

TEST_F(BodySection, WhatWouldDoNothingIsRefused) {
  const std::string ball = "{shape: ball, position_m: [0, 0, 5], ";
  for (const char* level : {"level: full, greatest_rung: support", "level: support, greatest_rung: tables",
                            "level: tables, least_rung: support", "level: statistical, least_rung: full"})
    EXPECT_NE(fault(ball + level + "}").find("expected one from least_rung to greatest_rung"),
              std::string::npos)
        << level;
  for (const char* level : {"level: full, least_rung: support", "level: tables, greatest_rung: support",
                            "level: statistical, least_rung: support", "level: auto, least_rung: full"})
    EXPECT_EQ(made(ball + level + "}").size(), 1u) << level;
  EXPECT_TRUE(made(ball + "asleep: true, velocity_m_per_s: [0, 0, 0]}").at(0).asleep);
  for (const char* key : {"velocity_m_per_s", "angular_velocity_rad_per_s"}) {
    const std::string message = fault(ball + "asleep: true, " + key + ": [0, 0, 1]}");
    EXPECT_NE(message.find(std::string(key) + ": found a body that moves and is asleep"), std::string::npos)
        << message;
  }
}

// A scatter is as many bodies as it says, within its region, apart, of its seed alone, numbered.
TEST_F(BodySection, AScatterFillsItsRegion) {
  const std::string scatter =
      "{shape: ball, name: b, scatter: {count: 30, box_m: [[-6, -6, 1], [6, 6, 6]], seed: 4}}";
  const std::vector<SceneBody> bodies = made(scatter), again = made(scatter);
  ASSERT_EQ(bodies.size(), 30U);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& place = bodies[i].definition.state.position;
    EXPECT_TRUE((Eigen::AlignedBox3d(Vec3(-6, -6, 1), Vec3(6, 6, 6)).contains(place)));
    EXPECT_EQ(bodies[i].name, "b[" + std::to_string(i) + "]");
    EXPECT_EQ(place, again[i].definition.state.position);
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GE((place - bodies[k].definition.state.position).norm(), 1.0 - 1e-9);
  }
  const std::vector<SceneBody> other = made(scatter.substr(0, scatter.size() - 3) + "5}}");
  EXPECT_NE(other[0].definition.state.position, bodies[0].definition.state.position);
}

TEST_F(BodySection, AScatterKeepsClearOfThoseThatArePlaced) {
  const std::vector<SceneBody> bodies = made(
      "{shape: crate, position_m: [0, 0, 3]}, {shape: ball, scatter: {count: 20, box_m: [[-3, -3, 1], [3, 3, "
      "5]]}}");
  for (std::size_t i = 1; i < bodies.size(); ++i)
    EXPECT_GE((bodies[i].definition.state.position - Vec3(0, 0, 3)).norm(),
              0.5 + bodies[0].definition.shape->radius - 1e-9);
}

TEST_F(BodySection, MoreThanThereIsRoomForIsSaid) {
  EXPECT_NE(fault("{shape: ball, scatter: {count: 500, box_m: [[0, 0, 1], [2, 2, 2]]}}").find("found room"),
            std::string::npos);
  EXPECT_NE(fault("{shape: ball, scatter: {count: 20, box_m: [[-9, -9, 1], [9, 9, 9]]}}, {shape: ball, "
                  "position_m: [0, 0, 20]}",
                  {.mesh_paths = {}, .seed = {}, .max_bodies = 20})
                .find("found 21 bodies, expected at most 20"),
            std::string::npos);
}

TEST_F(BodySection, WhatIsWrongIsSaidWithItsPlace) {
  EXPECT_TRUE(fault("{shape: ball}").starts_with("s.yaml:2: bodies[0]")) << fault("{shape: ball}");
  EXPECT_NE(fault("{shape: bal, position_m: [0, 0, 5]}").find("did you mean \"ball\"?"), std::string::npos);
  EXPECT_TRUE(fault("{shape: ball, position_m: [0, 0, 5]}, {shape: ball, position_m: [0, 0]}")
                  .starts_with("s.yaml:2: bodies[1].position_m"));
  for (const char* wrong : {"orientation: [0, 0, 0, 0]", "mass_kg: 0", "importance: 0",
                            "velocity_m_per_s: [1, 2]", "asleep: perhaps", "colour: red"})
    EXPECT_NE(fault(std::string("{shape: ball, position_m: [0, 0, 5], ") + wrong + "}"),
              testing::kNothingThrown)
        << wrong;
}

}  // namespace
}  // namespace lodestone
