// What a program watches a manager by.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct Line {
  Vec3 from, to;
  DebugColor color;
};

struct Drawing {
  std::vector<Line> lines;
  std::vector<std::pair<Vec3, DebugColor>> points;
  DebugDrawer drawer{.line =
                         [this](const Vec3& from, const Vec3& to, DebugColor color) {
                           lines.push_back({from, to, color});
                         },
                     .point = [this](const Vec3& at, DebugColor color) { points.emplace_back(at, color); }};
};

bool same(DebugColor a, DebugColor b) { return a.red == b.red && a.green == b.green && a.blue == b.blue; }

TEST(ManagerDraw, AHullIsItsEdgesWhereItIs) {
  Manager manager{unmeasured()};
  const Quat turn(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()));
  add(manager, box_shape({0.2, 0.3, 0.4}), at({1, 2, 3}, {0, 0, 0}, {0, 0, 0}, turn));
  Drawing drawing;
  manager.draw(drawing.drawer);
  EXPECT_EQ(drawing.points.size(), 1U);
  EXPECT_EQ(drawing.points[0].first, Vec3(1, 2, 3));
  // Twelve edges, and a diagonal for each side that is two triangles.
  std::map<long, int> lengths;  // mm
  for (const Line& line : drawing.lines) {
    ++lengths[std::lround(1000 * (line.to - line.from).norm())];
    for (const Vec3& end : {line.from, line.to})
      EXPECT_LT(((turn.conjugate() * (end - Vec3(1, 2, 3))).cwiseAbs() - Vec3(0.1, 0.15, 0.2)).norm(), 1e-9);
  }
  for (const long side : {200, 300, 400}) EXPECT_EQ(lengths[side], 4);
  EXPECT_EQ(drawing.lines.size(), 18U);
}

TEST(ManagerDraw, ASphereIsThreeCircles) {
  Manager manager{unmeasured()};
  add(manager, sphere_shape(0.5), at({1, 0, 0}));
  Drawing drawing;
  manager.draw(drawing.drawer);
  EXPECT_EQ(drawing.lines.size() % 3, 0U);
  for (const Line& line : drawing.lines)
    for (const Vec3& end : {line.from, line.to}) EXPECT_NEAR((end - Vec3(1, 0, 0)).norm(), 0.5, 1e-9);
  Vec3 ends = Vec3::Zero();  // closed
  for (const Line& line : drawing.lines) ends += line.to - line.from;
  EXPECT_LT(ends.norm(), 1e-9);
}

TEST(ManagerDraw, ColorsAreTheRungsAndHalfAsBrightAsleep) {
  Manager manager{unmeasured()};
  const auto box = box_shape({0.2, 0.2, 0.2});
  const BodyId support = add(manager, box, at({0, 0, 5})),
               full = add(manager, box, at({2, 0, 5}), LevelChoice::full);
  const DrawSettings settings;
  for (const bool asleep : {false, true}) {
    manager.step(kFrame);
    if (asleep) manager.sleep(support), manager.sleep(full);
    Drawing drawing;
    manager.draw(drawing.drawer);
    ASSERT_EQ(drawing.points.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      DebugColor color = settings.colors[std::size_t(i == 0 ? Rung::support : Rung::full)];
      const float light = asleep ? 0.5f : 1.0f;
      color = {light * color.red, light * color.green, light * color.blue};
      EXPECT_TRUE(same(drawing.points[i].second, color)) << i << asleep;
    }
  }
}

TEST(ManagerDraw, BoundsHoldTheHull) {
  Manager manager{unmeasured()};
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, -2, 1).normalized()));
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({1, 2, 3}, {0, 0, 0}, {0, 0, 0}, turn));
  Drawing drawing;
  manager.draw(drawing.drawer, {.bodies = false, .bounds = true});
  EXPECT_TRUE(drawing.points.empty());
  ASSERT_EQ(drawing.lines.size(), 12U);
  Eigen::AlignedBox3d drawn, exact;
  for (const Line& line : drawing.lines) drawn.extend(line.from), drawn.extend(line.to);
  for (const Vec3& vertex : manager.shape(body).hull.vertices) exact.extend(Vec3(1, 2, 3) + turn * vertex);
  EXPECT_LT((drawn.min() - exact.min()).norm() + (drawn.max() - exact.max()).norm(), 1e-9);
}

TEST(ManagerDraw, ContactsLieBetweenTheBodies) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::full}) {
    Manager manager = on_floor();
    const auto box = box_shape({0.4, 0.4, 0.4});
    add(manager, box, at({0, 0, 0.2}), level), add(manager, box, at({0, 0, 0.6}), level);
    for (int i = 0; i < 5; ++i) manager.step(kFrame);
    Drawing drawing;
    manager.draw(drawing.drawer, {.bodies = false, .normal_length = 0.25});
    int between = 0;
    for (const auto& [point, color] : drawing.points) {
      EXPECT_TRUE(same(color, DrawSettings{}.contact_color));
      between += std::abs(point.z() - 0.4) < 0.02;
    }
    EXPECT_GE(between, 1) << int(level);
    for (const Line& line : drawing.lines) EXPECT_NEAR((line.to - line.from).norm(), 0.25, 1e-9);
    Drawing none;
    manager.draw(none.drawer, {.bodies = false, .contacts = false});
    EXPECT_TRUE(none.points.empty() && none.lines.empty());
  }
}

TEST(ManagerDraw, WhatIsEmptyIsLeftOut) {
  Manager manager = on_floor();
  add(manager, box_shape({0.4, 0.4, 0.4}), at({0, 0, 0.2}));
  manager.step(kFrame);
  EXPECT_NO_THROW(manager.draw({}, {.bounds = true}));
  int points = 0;
  manager.draw({.point = [&](const Vec3&, DebugColor) { ++points; }}, {.bounds = true});
  EXPECT_GT(points, 0);
}

// Zones lie within each other as calls do; each step is one, with stages inside.
TEST(ManagerProfile, ZonesNestAndStepsAreWhole) {
  Manager manager = on_floor();
  const auto box = box_shape({0.2, 0.2, 0.2});
  add(manager, box, at({0, 0, 0.5})), add(manager, box, at({0.1, 0, 0.8}));
  add(manager, box, at({3, 0, 0.5}), LevelChoice::full);
  std::vector<std::string> open, seen;
  int steps = 0;
  manager.set_profile({.begin =
                           [&](std::string_view zone) {
                             steps += zone == "step";
                             EXPECT_EQ(open.empty(), zone == "step") << zone;
                             open.emplace_back(zone);
                             seen.emplace_back(zone);
                           },
                       .end =
                           [&](std::string_view zone) {
                             ASSERT_FALSE(open.empty());
                             EXPECT_EQ(open.back(), zone);
                             open.pop_back();
                           }});
  for (int i = 0; i < 3; ++i) manager.step(kFrame);
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(steps, 3);
  for (const char* zone : {"choose", "transfer", "flight", "broad_phase", "pairs", "crowd", "rest", "full"})
    EXPECT_NE(std::ranges::find(seen, zone), seen.end()) << zone;
  manager.set_profile({});
  const std::size_t before = seen.size();
  manager.step(kFrame);
  EXPECT_EQ(seen.size(), before);
}

// A profile that only listens to one end does no harm.
TEST(ManagerProfile, EitherHookAlone) {
  Manager manager = on_floor();
  add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0.5}));
  manager.step(kFrame);
  int begun = 0, ended = 0;
  manager.set_profile({.begin = [&](std::string_view) { ++begun; }});
  manager.step(kFrame);
  manager.set_profile({.end = [&](std::string_view) { ++ended; }});
  manager.step(kFrame);
  EXPECT_GT(begun, 3);
  EXPECT_EQ(begun, ended);
}

}  // namespace
}  // namespace lodestone
