// A ball that rolls on another body does so as on the ground, though the two take their contact along.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::ball_on_body_test {
namespace {

using namespace testing;

constexpr double kRadius = 0.1, kSpeed = 0.1;  // m, m/s

BodyId add_rolling(Manager& manager, double y, double speed, LevelChoice level) {
  static const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  RigidState state = at({0, y, kRadius});
  state.velocity.x() = speed, state.angular_velocity.y() = speed / kRadius;
  return add(manager, ball, state, level);
}

// Its point there, turned with it, pushed it from behind: .18 m/s after five seconds.
TEST(BallOnBody, RollsOnAsFast) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = coarse_signature});
    const auto slab = box_shape({6, 4, 0.2});
    manager.add_body(
        {.shape = slab, .state = at({0, 0, -0.1}), .level = level, .properties = {.kinematic = true}});
    const BodyId ball = add_rolling(manager, 0, kSpeed, level);
    run(manager, 5.0);
    EXPECT_NEAR(manager.state(ball).velocity.x(), kSpeed, 0.01 * kSpeed) << int(level);
    EXPECT_NEAR(manager.state(ball).position.z(), kRadius, 1e-4);
  }
}

// One of two side by side was set rolling by the other, which lay still, and went on to get faster.
TEST(BallOnBody, TwoSideBySideComeToRest) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = coarse_signature});
    const auto slab = box_shape({4, 20, 0.2});
    for (const double side : {-1.0, 1.0}) {  // of a groove
      const Quat turn(Eigen::AngleAxisd(-side * 0.35, Vec3::UnitY()));
      RigidState state = at(turn * Vec3(2.0 * side, 0, -0.1));
      state.orientation = turn;
      manager.add_body({.shape = slab, .state = state, .level = level, .properties = {.kinematic = true}});
    }
    const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
    const double height = kRadius / std::cos(0.35);
    const BodyId first = add(manager, ball, at({0, 0, height}), level),
                 second = add(manager, ball, at({0, 2.0 * kRadius, height + 0.02}), level);
    run(manager, 8.0);
    for (const BodyId body : {first, second})
      EXPECT_LT(manager.state(body).velocity.norm(), 0.02) << int(level);
  }
}

}  // namespace
}  // namespace lodestone::ball_on_body_test
