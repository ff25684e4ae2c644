// How a body of `support` comes to rest by itself, and what keeps it from it.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

/// s until it sleeps; `most` where it does not.
double time_to_rest(Manager& manager, BodyId body, double most = 4.0) {
  double t = 0.0;
  for (; t < most && !manager.asleep(body); t += kFrame) manager.step(kFrame);
  return t;
}

TEST(SupportRest, ALoneBodyThatLiesSleepsAfterFiveTimesTheThreshold) {
  for (const double time : {0.05, 0.2}) {
    ManagerSettings settings = unmeasured();
    settings.sleep.time = time;
    Manager manager = on_floor(settings);
    const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 0.1}));
    EXPECT_NEAR(time_to_rest(manager, body), 5.0 * time, 2.5 * kFrame) << time;
  }
}

// Woken it takes its time again, though it never moved.
TEST(SupportRest, WokenItTakesItsTimeAgain) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 0.1}));
  time_to_rest(manager, body);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(manager.asleep(body));
    manager.wake(body);
    EXPECT_NEAR(time_to_rest(manager, body), 0.5, 2.5 * kFrame);
  }
}

TEST(SupportRest, ScalesWithTheRootOfItsSize) {
  double drop[2];
  for (const int large : {0, 1}) {
    const double side = large ? 0.8 : 0.2;
    Manager manager = on_floor();
    const BodyId body =
        add(manager, box_shape({side, side, side}),
            testing::at({0, 0, 2 * side}, {0, 0, 0}, {1.0 / std::sqrt(side), 0.5 / std::sqrt(side), 0}));
    drop[large] = time_to_rest(manager, body, 10.0);
  }
  EXPECT_GT(drop[1], 1.2 * drop[0]);
  EXPECT_LT(drop[1], 4.0 * drop[0]);
}

TEST(SupportRest, WhoMayNotSleepDoesNot) {
  Manager manager = on_floor();
  const BodyId body = manager.add_body({.shape = box_shape({0.2, 0.2, 0.2}),
                                        .state = testing::at({0, 0, 0.1}),
                                        .properties = {.allow_sleep = false}});
  EXPECT_GE(time_to_rest(manager, body, 2.0), 2.0);
  EXPECT_NEAR(manager.state(body).position.z(), 0.1, 1e-3);
}

// In free fall at the top of its way it is as slow as one that rests, and falls on.
TEST(SupportRest, NothingRestsInTheAir) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 5}, {0, 0, 3}));
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    EXPECT_FALSE(manager.asleep(body));
  }
}

// Without gravity, at rest, it sleeps where it is only if something holds it: alone in space it drifts on.
TEST(SupportRest, ADriftingBodyDriftsOn) {
  ManagerSettings settings = unmeasured();
  settings.gravity = Vec3::Zero();
  Manager manager(settings);
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 0}, {0.01, 0, 0}));
  run(manager, 3.0);
  EXPECT_NEAR(manager.state(body).position.x(), 0.03, 1e-6);
}

TEST(SupportRest, AKinematicBodyRestsOnceItHasNoVelocity) {
  Manager manager = on_floor();
  BodyProperties driven;
  driven.kinematic = true;
  const BodyId body = manager.add_body({.shape = box_shape({0.2, 0.2, 0.2}),
                                        .state = testing::at({0, 0, 3}, {0.5, 0, 0}),
                                        .properties = driven});
  run(manager, 1.0);
  EXPECT_FALSE(manager.asleep(body));
  EXPECT_NEAR(manager.state(body).position.x(), 0.5, 1e-9);
  EXPECT_NEAR(manager.state(body).position.z(), 3.0, 1e-12);
  RigidState stopped = manager.state(body);
  stopped.velocity.setZero();
  manager.set_state(body, stopped);
  EXPECT_LT(time_to_rest(manager, body), 0.1);
  EXPECT_NEAR(manager.state(body).position.z(), 3.0, 1e-12);
}

// Turning is cut at the greatest speed, whatever it was given.
TEST(SupportRest, TheGreatestTurningSpeedIsKept) {
  ManagerSettings settings = unmeasured();
  settings.gravity = Vec3::Zero();
  Manager manager(settings);
  BodyProperties slow;
  slow.max_angular_speed = 2.0;
  const BodyId body = manager.add_body({.shape = sphere_shape(0.2),
                                        .state = testing::at({0, 0, 0}, {1, 0, 0}, {0, 30, 40}),
                                        .properties = slow});
  manager.step(kFrame);
  EXPECT_NEAR(manager.state(body).angular_velocity.norm(), 2.0, 1e-9);
  EXPECT_NEAR(manager.state(body).angular_velocity.z() / manager.state(body).angular_velocity.y(), 4.0 / 3,
              1e-9);
  EXPECT_EQ(manager.state(body).velocity, Vec3(1, 0, 0));
}

// Just beyond the angle of friction a stack sets out so slowly that for a while it is as slow as one that
// comes to rest.
TEST(SupportRest, AStackThatBeginsToSlideDoesNotSleep) {
  constexpr double kFriction = 0.5, kTime = 4.0;
  for (const double beyond : {1.05, 1.1})
    for (const double still_time : {0.1, 0.3}) {
      ManagerSettings settings = unmeasured();
      settings.sleep.time = still_time;
      Manager manager(settings);
      manager.materials().set_law(0, 0, {.restitution = 0.2, .friction = kFriction});
      const double slope = std::atan(kFriction * beyond);
      const Quat along(Eigen::AngleAxisd(-slope, Vec3::UnitY()));
      manager.add_plane(along * Vec3::UnitZ(), 0.0);
      std::vector<BodyId> stack;
      for (const int i : {0, 1})
        stack.push_back(add(manager, box_shape({0.4, 0.4, 0.2}),
                            {.position = along * Vec3(0, 0, 0.1005 + 0.201 * i), .orientation = along}));
      const Vec3 start = manager.state(stack[0]).position;
      run(manager, kTime);
      const double way = 0.5 * 9.81 * (std::sin(slope) - kFriction * std::cos(slope)) * kTime * kTime;
      EXPECT_NEAR((manager.state(stack[0]).position - start).norm(), way, 0.1 * way) << beyond;
    }
}

// Where nothing but friction acts it loses just that in each step, to the end: settling clips are of drops.
TEST(SupportRest, ABoxThatSlidesFlatDoesNotJolt) {
  constexpr double kFriction = 0.5, kSpeed = 3.0;  // m/s
  for (const Vec3& sides : {Vec3(1.2, 0.8, 0.6), Vec3(0.4, 0.3, 0.2)})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      Manager manager =
          on_floor({.signatures = coarse_signature, .signature_timing = SignatureTiming::in_step});
      manager.materials().set_law(0, 0, {.restitution = 0.2, .friction = kFriction});
      const BodyId body =
          add(manager, box_shape(sides), testing::at({0, 0, 0.5 * sides.z() + 1e-3}, {kSpeed, 0, 0}), level);
      run(manager, 0.1);
      double speed = manager.state(body).velocity.norm(), worst = 0.0;  // m/s
      for (int i = 0; i < 60; ++i) {
        manager.step(kFrame);
        const double now = manager.state(body).velocity.norm();
        worst = std::max(worst, speed - now - kFriction * 9.81 * kFrame);
        speed = now;
      }
      EXPECT_LT(worst, 0.003) << sides.transpose() << " at " << int(level);
      EXPECT_NEAR(manager.state(body).position.x(), 0.5 * kSpeed * kSpeed / (kFriction * 9.81), 0.02);
    }
}

// Balanced on an edge it may stand for a while; it does not fall asleep there.
TEST(SupportRest, OnAnEdgeNobodySleeps) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}),
                          testing::at({0, 0, 0.1 * std::sqrt(2.0)}, {0, 0, 0}, {0, 0, 0},
                                      Quat(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()))));
  while (manager.report().step < 600 && !manager.asleep(body)) manager.step(kFrame);
  if (manager.asleep(body)) {
    EXPECT_NEAR(manager.state(body).position.z(), 0.1, 2e-3);  // it fell onto a face first
  }
}

}  // namespace
}  // namespace lodestone
