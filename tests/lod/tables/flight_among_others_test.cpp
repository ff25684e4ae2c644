// Bodies of `tables` that fly near others, all of them the same way: what does not touch gives nothing.
#include <gtest/gtest.h>

#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// However fast both go: that of two one might be stopped by a third is no blow yet.
TEST(FlightAmongOthers, NobodyStrikesBeforeItTouches) {
  constexpr double kFlyerSide = 0.4, kFasterBy = 2.0;  // m, m/s
  const std::shared_ptr<const Shape> shapes[] = {
      box_shape({kFlyerSide, kFlyerSide, kFlyerSide}),
      std::make_shared<const Shape>(make_sphere_shape(0.5 * kFlyerSide))};
  for (const auto& shape : shapes)
    for (const double speed : {0.0, 30.0, -30.0}) {
      Manager manager({.gravity = {0, 0, 0}, .signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.8, .friction = 0.0});
      const BodyId behind =
                       add(manager, shape, at({0, 0, 0}, {speed + kFasterBy, 0, 0}), LevelChoice::tables),
                   before = add(manager, shape, at({1, 0, 0}, {speed, 0, 0}), LevelChoice::tables);
      double gap = 0.0;  // m, where the step of the blow began
      for (int step = 0; step < 60 && manager.state(before).velocity.x() < speed + 0.1; ++step) {
        gap = manager.state(before).position.x() - manager.state(behind).position.x() - kFlyerSide;
        manager.step(kFrame);
      }
      EXPECT_NEAR(manager.state(before).velocity.x(), speed + 0.9 * kFasterBy, 1e-3) << speed;
      EXPECT_LT(gap, 1.2 * kFasterBy * kFrame) << speed;
    }
}

// One behind the other, and never nearer.
TEST(FlightAmongOthers, NobodyLosesItsSpin) {
  constexpr double kFlyerSpin = 5.0, kFlyerSpeed = 20.0;  // rad/s, m/s
  Manager manager({.signatures = coarse_signature});
  std::vector<BodyId> cubes;
  for (int i = 0; i < 2; ++i) {
    RigidState thrown = at({0.55 * i, 0, 0}, {kFlyerSpeed, 0, 0});
    thrown.angular_velocity = {0, kFlyerSpin, 0};
    cubes.push_back(add(manager, box_shape({0.3, 0.3, 0.3}), thrown, LevelChoice::tables));
  }
  run(manager, 1.0);
  for (const BodyId cube : cubes) EXPECT_NEAR(manager.state(cube).angular_velocity.norm(), kFlyerSpin, 1e-3);
}

// A blow goes on through a ball that touches a wall as it does where that wall stands.
TEST(FlightAmongOthers, BlowsGoOnInATrainAsAtRest) {
  constexpr double kTrainBall = 0.2;  // m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kTrainBall));
  const auto rebound = [&](double speed) {
    Manager manager({.gravity = {0, 0, 0}, .signatures = coarse_signature});
    manager.materials().replace(0, {.restitution = 0.8, .friction = 0.0});
    const GroundId wall = manager.add_static_box({1, 4, 4}, {0.5, 0, 0}, Quat::Identity());
    add(manager, ball, at({-kTrainBall, 0, 0}, {speed, 0, 0}), LevelChoice::tables);
    const BodyId struck =
        add(manager, ball, at({-3.0 * kTrainBall - 0.1, 0, 0}, {speed + 2.0, 0, 0}), LevelChoice::tables);
    for (int step = 0; step < 30; ++step) {
      manager.move_ground(wall, {.position = {0.5 + speed * step * kFrame, 0, 0}, .velocity = {speed, 0, 0}});
      manager.step(kFrame);
    }
    return manager.state(struck).velocity.x() - speed;
  };
  const double at_rest = rebound(0.0);
  EXPECT_LT(at_rest, -1.0);
  for (const double speed : {3.0, 10.0}) EXPECT_NEAR(rebound(speed), at_rest, 0.02) << speed;
}

}  // namespace
}  // namespace lodestone
