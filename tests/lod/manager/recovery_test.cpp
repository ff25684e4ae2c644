// Hard case F15 within a run: bodies that no level can hold are put to rest and counted, and never reach ODE.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cstdarg>
#include <limits>
#include <stdexcept>
#include <utility>

#include "reference/random.h"
#include "reference/simulation_error.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone::recovery_test {
namespace {

using namespace testing;

TEST(Recovery, AStatisticalBodyThatFliesTooFarComesToRestAtTheLimit) {
  Manager manager(unmeasured());
  const BodyId body =
      add(manager, box_shape({0.2, 0.3, 0.4}), at({1e8 - 1e5, 5, 0}, {1e6, 0, 0}), LevelChoice::statistical);
  run(manager, 0.2);
  EXPECT_EQ(manager.state(body).position.x(), 1e8);
  EXPECT_EQ(manager.state(body).velocity.x(), 0.0);
  EXPECT_EQ(manager.report().counters.states_recovered, 1);
  manager.set_level(body, LevelChoice::full);
  run(manager, 0.2);
  EXPECT_EQ(manager.level(body), Level::full);
  EXPECT_EQ(manager.report().counters.states_recovered, 1);
}

TEST(Recovery, AForceBeyondAllBoundsStopsTheBodyAtEveryLevel) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager(unmeasured());
    const BodyId pushed = add(manager, box_shape({0.2, 0.3, 0.4}), at({1, 2, 3}), level);
    const BodyId beside = add(manager, box_shape({0.2, 0.3, 0.4}), at({1.5, 2, 3}), level);
    manager.step(kFrame);
    manager.add_force(pushed, {1e300, 0, 0}, {0, 1e300, 0});
    manager.step(kFrame);
    EXPECT_EQ(manager.report().counters.states_recovered,
              level == LevelChoice::full ? ManagerSettings{}.full_substeps : 1);
    EXPECT_LT((manager.state(pushed).position - Vec3(1, 2, 3)).norm(), 0.1);
    EXPECT_LT((manager.state(beside).position - Vec3(1.5, 2, 3)).norm(), 0.1);
    EXPECT_TRUE(manager.state(pushed).orientation.coeffs().allFinite());
  }
}

// What the caller does to an ODE body himself, between two steps: it is put back, at rest, before its
// neighbours can notice, who go on as if it had only been stopped.
TEST(Recovery, BodyThatTheCallerSpoiltIsPutBackAtRest) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  const auto shape = box_shape({0.2, 0.3, 0.4});
  const std::function<void(dBodyID)> spoils[] = {
      [](dBodyID body) { dBodySetPosition(body, kNan, 0, 0); },
      [](dBodyID body) { dBodySetLinearVel(body, 0, kNan, 0); },
      [](dBodyID body) { dBodySetAngularVel(body, 0, 0, kInfinity); },
      [](dBodyID body) { dBodyAddForce(body, kNan, 0, 0); },
      [](dBodyID body) { dBodyAddTorque(body, 0, -kInfinity, 0); }};
  const auto stop = [](dBodyID body) {
    dBodySetLinearVel(body, 0, 0, 0);
    dBodySetAngularVel(body, 0, 0, 0);
  };
  for (const auto& spoil : spoils) {
    std::vector<RigidState> ends[2];
    for (const bool spoilt : {false, true}) {
      Manager manager = on_floor();
      const BodyId lower = add(manager, shape, at({0, 0, 0.21}), LevelChoice::full),
                   upper = add(manager, shape, at({0.02, 0, 0.63}), LevelChoice::full);
      const BodyId hull = add(manager, shape, at({0.3, 0, 0.21}), LevelChoice::support);
      run(manager, 0.2);
      const Vec3 position = manager.state(lower).position;
      if (spoilt)
        spoil(manager.ode_body(lower));
      else
        stop(manager.ode_body(lower));
      manager.step(kFrame);
      EXPECT_EQ(manager.report().counters.states_recovered, spoilt ? 1 : 0);
      EXPECT_LT((manager.state(lower).position - position).norm(), 0.01);
      run(manager, 0.2);
      EXPECT_EQ(manager.report().counters.states_recovered, spoilt ? 1 : 0);
      for (const BodyId body : {lower, upper, hull}) ends[spoilt].push_back(manager.state(body));
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT((ends[0][std::size_t(i)].position - ends[1][std::size_t(i)].position).norm(), 1e-9) << i;
      EXPECT_LT((ends[0][std::size_t(i)].velocity - ends[1][std::size_t(i)].velocity).norm(), 1e-9) << i;
    }
  }
}

// An assertion inside ODE, here over a mass that the caller set himself: an error that names the body, and a
// manager that can still be read and destroyed.
TEST(Recovery, AssertionInsideOdeIsAnErrorThatNamesTheBody) {
  Manager manager = on_floor();
  const auto shape = box_shape({0.2, 0.3, 0.4});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 4; ++i)
    bodies.push_back(
        add(manager, shape, at({0.03 * i, 0, 0.19 + 0.38 * i}, {0, 0, 0}, {1, 2, 3}), LevelChoice::full));
  manager.step(kFrame);
  dMass light;
  dMassSetBoxTotal(&light, 1e-30, 0.2, 0.3, 0.4);
  dBodySetMass(manager.ode_body(bodies[2]), &light);
  const std::string message = message_of<SimulationError>([&] { run(manager, 5.0); });
  EXPECT_NE(message.find("ODE gave up"), std::string::npos) << message;
  EXPECT_NE(message.find("body 2"), std::string::npos) << message;
  try {
    manager.step(kFrame);
    ADD_FAILURE() << "steps on";
  } catch (const SimulationError& again) {
    EXPECT_EQ(again.body(), bodies[2].index) << "by the manager's index, not ODE's";
    EXPECT_EQ(again.what(), message);
  }
  EXPECT_EQ(manager.bodies(), 4);
}

TEST(Recovery, FastBodiesWithinTheLimitAreLeftAlone) {
  Manager manager(unmeasured());
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0}, {1e6, 0, 0}, {0, 0, 1e3}),
                          LevelChoice::statistical);
  run(manager, 0.5);
  EXPECT_EQ(manager.report().counters.states_recovered, 0);
  EXPECT_NEAR(manager.state(body).velocity.x(), 1e6, 1e-6);
}

// A pair filter that throws once: the step had begun for ever, and none could be taken any more.
TEST(Recovery, AWorldStepThatDidNotBeginCanBeBegunAgain) {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  {
    bool throws = true;
    ManagerSettings settings = unmeasured();
    settings.pair_filter = [&](BodyId, BodyId) {
      if (std::exchange(throws, false)) throw std::runtime_error("the caller's own");
      return true;
    };
    Manager manager(world, space, settings);
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const auto shape = box_shape({0.2, 0.2, 0.2});
    add(manager, shape, testing::at({0, 0, 0.1}), LevelChoice::full);
    const BodyId upper = add(manager, shape, testing::at({0, 0, 0.3}), LevelChoice::full);
    EXPECT_THROW(manager.before_world_step(kFrame), std::runtime_error);
    const std::int64_t step = manager.report().step;
    for (int i = 0; i < 60; ++i) {
      manager.before_world_step(kFrame);
      dWorldStep(world, kFrame);
      manager.after_world_step();
    }
    EXPECT_EQ(manager.report().step, step + 60);
    EXPECT_NEAR(manager.state(upper).position.z(), 0.3, 2e-3);
    EXPECT_NO_THROW(manager.step(kFrame));
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

// Where ODE's solver gives up, the substep is done again, in a caller's world, too, with his bodies as they
// were before it: full crates fell through a box that rose under them.
TEST(Recovery, WhatTheSolverGivesUpOnIsDoneAgainInACallersWorld) {
  constexpr int kCrates = 3;
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  {
    Manager manager(world, space, unmeasured());
    const GroundId lift = manager.add_static_box({2, 2, 0.2}, {0, 0, -0.1}, Quat::Identity());
    std::vector<BodyId> stack;
    for (int i = 0; i < kCrates; ++i)
      stack.push_back(add(manager, box_shape({0.5, 0.3, 0.2}), testing::at({0, 0, 0.101 + 0.201 * i}),
                          LevelChoice::full));
    const dBodyID flies = dBodyCreate(world);  // the caller's, by itself, at 2 m/s
    dGeomSetBody(dCreateBox(space, 0.2, 0.2, 0.2), flies);
    dBodySetPosition(flies, 5, 0, 0);
    dBodySetGravityMode(flies, 0);
    dBodySetLinearVel(flies, 2, 0, 0);
    run(manager, 1.0);
    double height = -0.1;
    for (int i = 0; i < 240; ++i) {
      manager.move_ground(lift, testing::at({0, 0, height}, {0, 0, 1}));
      manager.step(kFrame);
      height += kFrame;
    }
    EXPECT_GT(manager.report().counters.ode_messages, 0);  // else nothing was tried here
    for (int i = 0; i < kCrates; ++i)
      EXPECT_NEAR(manager.state(stack[std::size_t(i)]).position.z(), height + 0.2 + 0.2 * i, 0.05);
    EXPECT_NEAR(dBodyGetPosition(flies)[0], 5.0 + 2.0 * 5.0, 1e-9);
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

int callers_messages = 0;
void count_callers_message(int, const char*, va_list) { ++callers_messages; }

// In a caller's own loop nothing can be done again: but it must not be given up on in frame after frame, in
// which its bodies fall through the ground.
TEST(Recovery, WhatACallersStepGaveUpOnIsSolvedInTheNextOnes) {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetERP(world, 0.2);
  dWorldSetCFM(world, 1e-10);
  dCreatePlane(space, 0, 0, 1, 0);
  dMessageFunction* const before = dGetMessageHandler();
  {
    Manager manager(world, space, unmeasured());
    dSetMessageHandler(count_callers_message);  // the caller's, later than ours: it is told all the same
    callers_messages = 0;
    std::vector<BodyId> pyramid;
    for (int row = 0; row < 6; ++row)
      for (int i = 0; i < 6 - row; ++i)
        pyramid.push_back(add(manager, box_shape({0.3, 0.3, 0.3}),
                              testing::at({0.31 * (i + 0.5 * row), 0, 0.151 + 0.302 * row}),
                              LevelChoice::full));
    RandomStream random(5, 0, 0);
    int with_messages = 0, longest = 0;  // frames in a row
    for (int frame = 0; frame < 400; ++frame) {
      if (frame > 60 && frame % 20 == 0) {
        const BodyId body = pyramid[std::size_t(random.uniform() * double(pyramid.size()))];
        const Vec3 kick(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform());
        manager.add_impulse(body, manager.mass(body) * kick, manager.state(body).position);
      }
      const int known = callers_messages;
      manager.before_world_step(kFrame);
      dWorldStep(world, kFrame);
      manager.after_world_step();
      with_messages = callers_messages > known ? with_messages + 1 : 0;
      longest = std::max(longest, with_messages);
      for (const BodyId body : pyramid) ASSERT_GT(manager.state(body).position.z(), 0.0) << frame;
    }
    EXPECT_GT(callers_messages, 0);  // else nothing was tried here
    EXPECT_LE(callers_messages, 20);
    EXPECT_LE(longest, 4);
  }
  dSetMessageHandler(before);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

}  // namespace
}  // namespace lodestone::recovery_test
