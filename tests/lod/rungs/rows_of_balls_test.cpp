// Balls that touch: at tables they roll down a slope like one by itself, and hand a blow on, as at support.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lod/lodestone.h"

namespace lodestone {
namespace {

constexpr double kBallFrame = 1.0 / 60, kStrength = 9.81, kBall = 0.1;  // s, m/s², m

std::shared_ptr<const Shape> ball() {
  static const auto shape = std::make_shared<const Shape>(make_sphere_shape(kBall));
  return shape;
}

BodyId add_ball(Manager& manager, LevelChoice level, const Vec3& position,
                const Vec3& velocity = Vec3::Zero()) {
  return manager.add_body(
      {.shape = ball(), .state = {.position = position, .velocity = velocity}, .level = level});
}

void step_on(Manager& manager, int steps) {
  for (int i = 0; i < steps; ++i) manager.step(kBallFrame);
}

TEST(RowsOfBalls, BallsThatTouchRollDownASlope) {
  for (const double degrees : {1.0, 2.0, 5.0}) {
    Manager manager({.signature_timing = SignatureTiming::in_step});
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vec3 up(std::sin(angle), 0, std::cos(angle)), down(std::cos(angle), 0, -std::sin(angle));
    manager.add_plane(up, 0.0);
    std::vector<BodyId> balls;
    for (int i = 0; i < 3; ++i)
      balls.push_back(add_ball(manager, LevelChoice::tables, kBall * up + 2 * kBall * i * down));
    const Vec3 start = manager.state(balls[2]).position;
    step_on(manager, 120);
    const double way = 0.5 * 4.0 * kStrength * std::sin(angle) * 5.0 / 7.0;
    EXPECT_NEAR((manager.state(balls[2]).position - start).norm(), way, 0.03 * way) << degrees;
  }
}

struct Row {
  double momentum = 0.0, first = 0.0, last = 0.0;  // over the mass; m/s
};

// After it was struck at 4 m/s.
Row strike_row(LevelChoice level, double restitution) {
  Manager manager({.signature_timing = SignatureTiming::in_step});
  manager.materials().set_law(0, 0, {.restitution = restitution, .friction = 0.0});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  std::vector<BodyId> balls = {add_ball(manager, level, {-0.8, 0, kBall}, {4, 0, 0})};
  for (int i = 0; i < 5; ++i) balls.push_back(add_ball(manager, level, {0.2 * i, 0, kBall}));
  step_on(manager, 24);
  Row row{.first = manager.state(balls.front()).velocity.x(),
          .last = manager.state(balls.back()).velocity.x()};
  for (const BodyId id : balls) row.momentum += manager.state(id).velocity.x();
  return row;
}

TEST(RowsOfBalls, ARowKeepsItsMomentumAndDoesNotThrowTheStrikerBack) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double restitution : {0.2, 0.5, 0.8}) {
      const Row row = strike_row(level, restitution);
      EXPECT_NEAR(row.momentum, 4.0, 1e-4) << restitution;
      EXPECT_GE(row.first, 0.0) << restitution;
      EXPECT_GE(row.last, 4.0 * std::pow(0.5 * (1 + restitution), 5) - 1e-3) << restitution;
    }
}

}  // namespace
}  // namespace lodestone
