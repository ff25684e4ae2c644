// What others drive at a wall, or at a third body, within a step was not on its way there when that was
// looked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::struck_into_ground_test {
namespace {

using testing::add;
using testing::coarse_signature;
using testing::kFrame;

constexpr double kStruckRadius = 0.05,
                 kStrikerRadius =
                     0.1;  // m: radii of what is struck, and of a ball of eight times its density

// How many of those before a wall `thick` m thick, at 16 distances, are behind it after a second.
int pass_wall(LevelChoice level, bool is_ball, double speed, double thick) {
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kStruckRadius)),
             striker = std::make_shared<const Shape>(make_sphere_shape(kStrikerRadius)),
             box = testing::box_shape({2 * kStruckRadius, 2 * kStruckRadius, 2 * kStruckRadius});
  Manager manager = testing::on_floor({.signatures = coarse_signature});
  manager.add_static_box({thick, 90, 40}, {0.5 * thick, 0, 20}, Quat::Identity());
  std::vector<BodyId> struck;
  for (int i = 0; i < 16; ++i) {
    const double x = -kStruckRadius - 0.02 - 0.037 * i, y = 3.0 * i - 24.0;  // m
    struck.push_back(add(manager, is_ball ? ball : box, testing::at({x, y, kStruckRadius}), level));
    RigidState coming = testing::at({x - 0.5, y, kStrikerRadius});
    coming.velocity.x() = speed;
    manager.add_body({.shape = striker, .state = coming, .mass = 8.4, .level = level});
  }
  for (int frame = 0; frame < 60; ++frame) manager.step(kFrame);
  return int(std::ranges::count_if(
      struck, [&](BodyId body) { return manager.state(body).position.x() > 0.5 * thick; }));
}

TEST(StruckIntoGround, NothingPassesAWall) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const bool is_ball : {false, true})
      for (const double speed : {10.0, 40.0})
        for (const double thick : {0.02, 0.2})
          EXPECT_EQ(pass_wall(level, is_ball, speed, thick), 0)
              << int(level) << (is_ball ? " ball, " : " box, ") << speed << " m/s, " << thick << " m";
}

// More than a thousand, so that they stand in several blocks, of which the last have nobody later: what was
// noted of bodies there says nothing of who has come to their places, behind other walls.
TEST(StruckIntoGround, WhoWasStruckOnceIsLeftAloneLater) {
  Manager manager({.signatures = coarse_signature});
  manager.add_static_box({90, 90, 1}, {0, 0, -0.5}, Quat::Identity());
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kStruckRadius));
  std::vector<BodyId> balls;
  for (int i = 0; i < 1'300; ++i) {
    const double x = 0.5 * (i / 2 % 26) - 6.0, y = 0.5 * (i / 52) - 6.0;  // m
    RigidState state = testing::at({x, y, kStruckRadius + 0.5 + 0.25 * (i % 2)});
    state.velocity.z() = i % 2 == 0 ? 0.0 : -10.0;
    balls.push_back(manager.add_body({.shape = ball, .state = state, .level = LevelChoice::tables}));
  }
  for (int i = 0; i < 25; ++i)
    manager.add_static_box({0.02, 90, 4}, {0.5 * i - 5.75, 0, 2}, Quat::Identity());
  manager.step(kFrame);  // in which all are struck
  for (std::size_t i = 2; i < balls.size(); ++i) manager.sleep(balls[i]);
  for (int frame = 0; frame < 5; ++frame) {
    std::vector<Vec3> before;
    for (const BodyId body : balls) before.push_back(manager.state(body).position);
    manager.step(kFrame);
    for (std::size_t i = 2; i < balls.size(); ++i)
      ASSERT_EQ(manager.state(balls[i]).position, before[i]) << i << " in frame " << frame;
  }
}

// One flies at two that sleep one behind the other, a little apart: the second is out of the first one's
// reach until that is struck. How many of 40 rows are in another order half a second later.
int pass_in_a_row(LevelChoice striker, LevelChoice level, bool is_ball, double speed) {
  constexpr double kRadius = 0.05;  // m
  const auto shape = is_ball ? std::make_shared<const Shape>(make_sphere_shape(kRadius))
                             : testing::box_shape({2 * kRadius, 2 * kRadius, 2 * kRadius});
  ManagerSettings settings{.signatures = coarse_signature};
  Manager manager = testing::on_floor(settings);
  manager.materials().replace(0, {.restitution = 0.5, .friction = 0.0});
  std::vector<std::array<BodyId, 3>> rows;
  for (int i = 0; i < 40; ++i) {
    const double y = 2.0 * i, gap = 0.002 + 0.0004 * i;  // m
    RigidState coming = testing::at({-0.6 - 0.025 * i, y, kRadius});
    coming.velocity.x() = speed;
    rows.push_back({add(manager, shape, coming, striker),
                    add(manager, shape, testing::at({0, y, kRadius}), level),
                    add(manager, shape, testing::at({2 * kRadius + gap, y, kRadius}), level)});
    manager.sleep(rows.back()[1]), manager.sleep(rows.back()[2]);
  }
  for (int frame = 0; frame < 30; ++frame) manager.step(kFrame);
  const auto has_passed = [&](BodyId behind, BodyId before) {  // and not beside it
    const Vec3 way = manager.state(behind).position - manager.state(before).position;
    return way.x() > 0.0 && std::abs(way.y()) < 2 * kRadius;
  };
  return int(std::ranges::count_if(
      rows, [&](const auto& row) { return has_passed(row[0], row[1]) || has_passed(row[1], row[2]); }));
}

TEST(StruckIntoOthers, NothingPassesAnother) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const bool is_ball : {false, true})
      for (const double speed : {10.0, 15.0, 30.0})
        EXPECT_EQ(pass_in_a_row(level, level, is_ball, speed), 0)
            << int(level) << (is_ball ? " ball, " : " box, ") << speed << " m/s";
}

TEST(StruckIntoOthers, NoBallStruckByAHullPassesAnother) {
  for (const double speed : {10.0, 15.0})
    EXPECT_EQ(pass_in_a_row(LevelChoice::support, LevelChoice::tables, true, speed), 0) << speed << " m/s";
}

}  // namespace
}  // namespace lodestone::struck_into_ground_test
