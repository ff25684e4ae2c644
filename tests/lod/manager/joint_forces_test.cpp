// What joints do besides holding: of kinds that are known by ODE's feedback alone.
#include "lod/manager/joint_forces.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::joint_forces_test {
namespace {

using namespace testing;

constexpr double kJointedCrate = 0.3;  // m, of crates

struct JointedWorld {
  JointedWorld() { dWorldSetGravity(world, 0, 0, -9.81); }
  ~JointedWorld() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  dBodyID add_plate(const Vec3& sides, double mass, const Vec3& at) {
    const dBodyID body = dBodyCreate(world);
    dMass m;
    dMassSetBoxTotal(&m, mass, sides.x(), sides.y(), sides.z());
    dBodySetMass(body, &m);
    dBodySetPosition(body, at.x(), at.y(), at.z());
    dGeomSetBody(dCreateBox(space, sides.x(), sides.y(), sides.z()), body);
    return body;
  }
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dGeomID floor = dCreatePlane(space, 0, 0, 1, 0);
};

BodyId add_box(Manager& manager, const Vec3& at, double mass) {
  return manager.add_body({.shape = box_shape({kJointedCrate, kJointedCrate, kJointedCrate}),
                           .state = testing::at(at),
                           .mass = mass,
                           .level = LevelChoice::support});
}

// Who is joined to it over others, too, is awake: by ODE alone those are laid down again in each of its
// steps.
TEST(JointForces, AForceOnASleeperMovesAllThatIsJoinedToIt) {
  constexpr int kCubes = 4;
  constexpr double kSide = 0.2, kMass = 8.0, kFriction = 0.5;  // m, kg
  for (const bool woken : {false, true}) {
    JointedWorld theirs;
    Manager manager(theirs.world, theirs.space, unmeasured());
    const auto cube = box_shape({kSide, kSide, kSide});
    std::vector<BodyId> chain;
    for (int i = 0; i < kCubes; ++i)
      chain.push_back(add(manager, cube, at({-0.25 * i, 0, 0.5 * kSide}), LevelChoice::full));
    run(manager, kFrame);
    for (int i = 0; i + 1 < kCubes; ++i) {
      const dJointID joint = dJointCreateBall(theirs.world, nullptr);
      dJointAttach(joint, manager.ode_body(chain[std::size_t(i)]),
                   manager.ode_body(chain[std::size_t(i) + 1]));
      dJointSetBallAnchor(joint, -0.25 * i - 0.125, 0, 0.5 * kSide);
    }
    run(manager, 2.0);
    ASSERT_EQ(manager.report().asleep, kCubes);
    if (woken) manager.wake(chain[0]);
    for (int frame = 0; frame < 60; ++frame) {
      manager.add_force(chain[0], {1.3 * kFriction * kCubes * kMass * 9.81, 0, 0});
      manager.step(kFrame);
    }
    EXPECT_NEAR(manager.state(chain[0]).position.x(), 0.5 * 0.3 * kFriction * 9.81, 0.02) << woken;
  }
}

// A full sled with crates that sleep on it, pulled with 60 N more than friction holds: by a motor, or by a
// body on a joint. Laid down again in each substep, they held it for ever.
TEST(JointForces, WhoSleepsOnWhatIsPulledComesAlong) {
  constexpr double kSled = 30.0, kCrate = 8.0, kTug = 2.0;  // kg
  constexpr double kMore = 60.0, kSeconds = 1.0;
  constexpr int kCrates = 3, kFrames = int(kSeconds / kFrame);
  for (const bool by_motor : {true, false}) {
    JointedWorld theirs;
    Manager manager(theirs.world, theirs.space, unmeasured());
    const auto add_full = [&](const Vec3& sides, const Vec3& place, double mass) {
      return manager.add_body(
          {.shape = box_shape(sides), .state = at(place), .mass = mass, .level = LevelChoice::full});
    };
    const BodyId sled = add_full({1.0, 0.6, 0.1}, {0, 0, 0.05}, kSled);
    for (int i = 0; i < kCrates; ++i) add_full({0.3, 0.3, 0.3}, {0.3 * i - 0.3, 0, 0.25}, kCrate);
    const double mass = kSled + kCrates * kCrate + (by_motor ? 0.0 : kTug), force = 0.5 * 9.81 * mass + kMore;
    dBodyID tug = nullptr;
    dJointID motor = nullptr;
    if (by_motor) {
      motor = dJointCreateSlider(theirs.world, nullptr);
      dJointAttach(motor, manager.ode_body(sled), nullptr);
      dJointSetSliderAxis(motor, 1, 0, 0);
    } else {
      tug = theirs.add_plate({0.1, 0.1, 0.1}, kTug, {0.6, 0, 0.05});
      const dJointID joint = dJointCreateBall(theirs.world, nullptr);
      dJointAttach(joint, manager.ode_body(sled), tug);
      dJointSetBallAnchor(joint, 0.54, 0, 0.05);
    }
    run(manager, by_motor ? 1.0 : 0.5);
    EXPECT_EQ(manager.report().asleep, by_motor ? kCrates + 1 : 0);
    const double start = manager.state(sled).position.x();
    manager.wake(sled);
    if (by_motor)
      dJointSetSliderParam(motor, dParamFMax, force), dJointSetSliderParam(motor, dParamVel, 10.0);
    for (int frame = 0; frame < kFrames; ++frame) {
      if (tug) dBodyAddForce(tug, force * std::min(1.0, frame / 10.0), 0, 0);
      manager.step(kFrame);
    }
    const double way = manager.state(sled).position.x() - start,
                 by_coulomb = 0.5 * kMore / mass * kSeconds * kSeconds;  // m; ODE: .38 to .7
    EXPECT_GT(way, 0.6 * by_coulomb) << by_motor;
    EXPECT_LT(way, 1.5 * by_coulomb) << by_motor;
  }
}

// A cube that sleeps on a joint to the world: what its author changes there wakes it, as it would not in ODE.
TEST(JointForces, ASleeperFeelsWhatIsDoneToItsJoint) {
  struct Case {
    const char* what;
    void (*change)(dJointID joint, dBodyID body);
    double least;  // m, that it moves in half a second
  };
  for (const auto& [what, change, least] :
       {Case{"destroyed", [](dJointID joint, dBodyID) { dJointDestroy(joint); }, 1.0},
        {"motor", [](dJointID joint, dBodyID) { dJointSetSliderParam(joint, dParamVel, 1.0); }, 0.4},
        {"stop", [](dJointID joint, dBodyID) { dJointSetSliderParam(joint, dParamLoStop, 0.1); }, 0.05},
        {"force", [](dJointID, dBodyID body) { dBodyAddForce(body, 500, 0, 0); }, 0.02},
        {"nothing", [](dJointID, dBodyID) {}, 0.0}}) {
    JointedWorld theirs;
    Manager manager(theirs.world, theirs.space, unmeasured());
    const Vec3 start(0, 0, 3);
    const BodyId cube = add(manager, box_shape({0.2, 0.2, 0.2}), at(start), LevelChoice::full);
    run(manager, kFrame);
    const dJointID joint = dJointCreateSlider(theirs.world, nullptr);
    const double power = std::string_view(what) == "force" || std::string_view(what) == "stop" ? 0.0 : 100.0;
    dJointAttach(joint, manager.ode_body(cube), nullptr);
    dJointSetSliderAxis(joint, 1, 0, 0);
    dJointSetSliderParam(joint, dParamFMax, power);
    manager.set_state(cube, at(start));
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(cube)) << what;
    const Vec3 before = manager.state(cube).position;
    change(joint, manager.ode_body(cube));
    run(manager, 0.5);
    const double moved = (manager.state(cube).position - before).norm();
    EXPECT_GE(moved, least) << what;
    if (least == 0.0) {
      EXPECT_TRUE(manager.asleep(cube));
    }
  }
}

TEST(JointForces, APistonPushesARow) {
  JointedWorld theirs;
  Manager manager(theirs.world, theirs.space, unmeasured());
  std::vector<BodyId> row;
  for (int i = 0; i < 3; ++i) row.push_back(add_box(manager, {0.31 * i, 0, kJointedCrate / 2}, 5.0));
  run(manager, 1.0);
  const dBodyID plate = theirs.add_plate({0.1, 1.0, 0.6}, 20.0, {-0.21, 0, 0.35});
  const dJointID piston = dJointCreatePiston(theirs.world, nullptr);
  dJointAttach(piston, plate, nullptr);
  dJointSetPistonAnchor(piston, -0.5, 0, 0.35);
  dJointSetPistonAxis(piston, 1, 0, 0);
  dJointSetPistonParam(piston, dParamVel, 0.3);
  dJointSetPistonParam(piston, dParamFMax, 1000.0);
  run(manager, 2.0);
  EXPECT_NEAR(dBodyGetPosition(plate)[0], -0.21 + 0.6, 0.02);
  EXPECT_NEAR(manager.state(row.front()).position.x(), 0.59, 0.02);
}

// In steps of the caller's, as long as those for which he made the spring. Nothing sleeps, which would end
// the swing where it is slow.
TEST(JointForces, ASpringBearsWhatLiesOnIt) {
  constexpr double kStiffness = 3000.0, kDamping = 200.0, kPlate = 5.0, kCrateMass = 10.0;  // N/m, N s/m, kg
  JointedWorld theirs;
  Manager manager(theirs.world, theirs.space, {.sleeping = false, .signatures = no_signature});
  const dBodyID plate = theirs.add_plate({1, 1, 0.1}, kPlate, {0, 0, 0.5});
  const dJointID slider = dJointCreateSlider(theirs.world, nullptr);
  dJointAttach(slider, plate, nullptr);
  dJointSetSliderAxis(slider, 0, 0, 1);
  dJointSetSliderParam(slider, dParamLoStop, 0.0);
  dJointSetSliderParam(slider, dParamHiStop, 0.2);
  dJointSetSliderParam(slider, dParamStopERP, kFrame * kStiffness / (kFrame * kStiffness + kDamping));
  dJointSetSliderParam(slider, dParamStopCFM, 1.0 / (kFrame * kStiffness + kDamping));
  std::vector<BodyId> stack;
  for (int i = 0; i < 2; ++i) stack.push_back(add_box(manager, {0, 0, 0.75 + 0.31 * i}, kCrateMass));
  for (int i = 0; i < 300; ++i) {
    manager.before_world_step(kFrame);
    dWorldStep(theirs.world, kFrame);
    manager.after_world_step();
  }
  const double height = dBodyGetPosition(plate)[2];
  EXPECT_NEAR(height, 0.5 - (kPlate + 2 * kCrateMass) * 9.81 / kStiffness, 0.0005);
  for (std::size_t i = 0; i < stack.size(); ++i)
    EXPECT_NEAR(manager.state(stack[i]).position.z() - height, 0.05 + kJointedCrate * (double(i) + 0.5),
                0.002);
}

TEST(JointForces, SnapshotsKnowThem) {
  struct Saved {
    Vec3 position, velocity;
  };
  struct World {
    World() : manager(theirs.world, theirs.space, unmeasured()) {
      plate = theirs.add_plate({0.1, 1.0, 0.6}, 20.0, {-0.21, 0, 0.35});
      const dJointID piston = dJointCreatePiston(theirs.world, nullptr);
      dJointAttach(piston, plate, nullptr);
      dJointSetPistonAnchor(piston, -0.5, 0, 0.35);
      dJointSetPistonAxis(piston, 1, 0, 0);
      dJointSetPistonParam(piston, dParamVel, 0.3);
      dJointSetPistonParam(piston, dParamFMax, 60.0);
      for (int i = 0; i < 3; ++i) add_box(manager, {0.31 * i, 0, kJointedCrate / 2}, 5.0);
    }
    JointedWorld theirs;
    Manager manager;
    dBodyID plate = nullptr;
  };
  World writer;
  run(writer.manager, 1.0);
  const auto snapshot = writer.manager.snapshot();
  const dReal *p = dBodyGetPosition(writer.plate), *q = dBodyGetQuaternion(writer.plate),
              *v = dBodyGetLinearVel(writer.plate), *w = dBodyGetAngularVel(writer.plate);
  World reader;
  dBodySetPosition(reader.plate, p[0], p[1], p[2]), dBodySetQuaternion(reader.plate, q);
  dBodySetLinearVel(reader.plate, v[0], v[1], v[2]), dBodySetAngularVel(reader.plate, w[0], w[1], w[2]);
  reader.manager.restore(snapshot);
  run(writer.manager, 0.5), run(reader.manager, 0.5);
  EXPECT_EQ(reader.manager.state_hash(), writer.manager.state_hash());
}

TEST(JointForces, TheFeedbackOfJointsIsTheCallersAgain) {
  JointedWorld theirs;
  Manager manager(theirs.world, theirs.space, unmeasured());
  add_box(manager, {0, 0, kJointedCrate / 2}, 5.0);
  dJointFeedback own{};
  std::vector<dJointID> joints;
  for (dJointFeedback* feedback : {static_cast<dJointFeedback*>(nullptr), &own}) {
    const dBodyID plate = theirs.add_plate({0.1, 0.1, 0.1}, 2.0, {1.0 + double(joints.size()), 0, 1});
    joints.push_back(dJointCreateBall(theirs.world, nullptr));
    dJointAttach(joints.back(), plate, nullptr);
    dJointSetBallAnchor(joints.back(), dBodyGetPosition(plate)[0], 0, 1);
    dJointSetFeedback(joints.back(), feedback);
  }
  run(manager, 0.1);
  EXPECT_EQ(dJointGetFeedback(joints[0]), nullptr);
  EXPECT_EQ(dJointGetFeedback(joints[1]), &own);
  EXPECT_NEAR(own.f1[2], 2.0 * 9.81, 1e-6);
}

}  // namespace
}  // namespace lodestone::joint_forces_test
