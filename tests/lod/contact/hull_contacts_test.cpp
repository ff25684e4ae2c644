#include "lod/contact/hull_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(HullContacts, SupportHeightOfABoxIsItsClosedForm) {
  const Vec3 half(0.1, 0.15, 0.2);
  const Shape shape = make_shape("box", make_box(2.0 * half));
  std::int32_t hint = 0;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    RandomStream random(3, i, 0);
    const Quat q = random.orientation();
    const double expected = (q.conjugate() * Vec3::UnitZ()).cwiseAbs().dot(half);
    EXPECT_NEAR(-find_lowest_point(shape, q, Vec3::UnitZ(), 0.0, hint).gap, expected, 1e-12);
  }
}

// S13, figure 3 of the paper: a square of side 1, as a long prism turning about its axis.
TEST(HullContacts, SquareOfFigureThreeStaysBetweenHalfAndRootHalf) {
  const Shape prism = make_shape("prism", make_box({1.0, 8.0, 1.0}));
  std::int32_t hint = 0;
  double lowest = 10.0, highest = 0.0;
  for (int degree = 0; degree <= 360; ++degree) {
    const Quat q = rotation_from_vector({0.0, degree * std::numbers::pi / 180.0, 0.0});
    const double height = -find_lowest_point(prism, q, Vec3::UnitZ(), 0.0, hint).gap;
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  EXPECT_NEAR(lowest, 0.5, 1e-12);
  EXPECT_NEAR(highest, std::sqrt(0.5), 1e-12);
}

TEST(HullContacts, FlatBoxStandsOnItsFourCorners) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  std::int32_t hint = 0;
  const HullContacts found = find_hull_contacts(shape, Quat::Identity(), Vec3::UnitZ(), 0.2, 0.001, hint);
  ASSERT_EQ(found.count, 4);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.contact[i].gap, 0.0, 1e-12);
    sum += found.contact[i].arm;
  }
  EXPECT_LT((sum / 4 - Vec3(0, 0, -0.2)).norm(), 1e-12);
}

// Gaps below the margin by less than single precision tells. Called twice: the first call leaves on the stack
// what the second must not read.
TEST(HullContacts, VerticesAtTheMarginAreNone) {
  const Shape cube = make_shape("cube", make_box({0.5, 0.5, 0.5}));
  std::int32_t hint = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(find_hull_contacts(cube, Quat::Identity(), Vec3::UnitZ(), 0.25, 0.001, hint).count, 4);
    EXPECT_EQ(find_hull_contacts(cube, Quat::Identity(), Vec3::UnitZ(), 0.5 - 1e-12, 0.25, hint).count, 1);
  }
}

TEST(HullContacts, EdgeGivesTwoAndCornerOne) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  std::int32_t hint = 0;
  const Quat on_edge = rotation_from_vector({0.7, 0.0, 0.0});
  const double height = -find_lowest_point(shape, on_edge, Vec3::UnitZ(), 0.0, hint).gap;
  EXPECT_EQ(find_hull_contacts(shape, on_edge, Vec3::UnitZ(), height, 0.001, hint).count, 2);
  const Quat on_corner = rotation_from_vector({0.5, 0.4, 0.1});
  const double corner_height = -find_lowest_point(shape, on_corner, Vec3::UnitZ(), 0.0, hint).gap;
  EXPECT_EQ(find_hull_contacts(shape, on_corner, Vec3::UnitZ(), corner_height, 0.001, hint).count, 1);
}

// A box on one edge that turns down about it: the far edge comes, and is found before it is there.
TEST(HullContacts, WhatComesWithinTheStepIsFound) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  std::int32_t hint = 0;
  const Quat tilted = rotation_from_vector({0.05, 0.0, 0.0});  // rad, about x: 15 mm under the far edge
  const double height = -find_lowest_point(shape, tilted, Vec3::UnitZ(), 0.0, hint).gap;
  EXPECT_EQ(find_hull_contacts(shape, tilted, Vec3::UnitZ(), height, 0.001, hint).count, 2);
  const Vec3 turn = tilted.conjugate() * Vec3(-0.1, 0.0, 0.0), normal = tilted.conjugate() * Vec3::UnitZ();
  const GapChange change{.of_arm = normal.cross(turn)};
  const HullContacts found = find_hull_contacts(shape, tilted, Vec3::UnitZ(), height, 0.001, hint, change);
  EXPECT_EQ(found.count, 4);
  for (int i = 0; i < found.count; ++i)  // gaps are those of now
    EXPECT_NEAR(found.contact[std::size_t(i)].gap, height + found.contact[std::size_t(i)].arm.z(), 1e-12);
}

// Of four hundred points on an ellipsoid of these half axes, m.
Shape round_hull(RandomStream& random, const Vec3& half_axes) {
  std::vector<Vec3> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(half_axes.cwiseProduct(random.direction()));
  Shape shape;
  shape.hull = make_hull(points);
  for (const Vec3& v : shape.hull.vertices) shape.radius = std::max(shape.radius, v.norm());
  return shape;
}

// A round hull that tips rolls onto a vertex between those that lie widest, which is found beforehand.
TEST(HullContacts, TheVertexOntoWhichABodyTipsIsFound) {
  RandomStream random(65, 0, 0);
  const Shape shape = round_hull(random, {0.1, 0.08, 0.09});
  int more = 0;
  for (int i = 0; i < 1000; ++i) {
    const Quat orientation = random.orientation();
    std::int32_t hint = 0;
    const double height = -find_lowest_point(shape, orientation, Vec3::UnitZ(), 0.0, hint).gap;
    const Tipping tipping{.turn = 0.04 * random.direction(), .by_lever = 0.5 * Mat3::Identity()};
    const HullContacts found =
        find_hull_contacts(shape, orientation, Vec3::UnitZ(), height, 0.004, hint, {}, tipping);
    const Vec3 lever = found.contact[0].arm.cross(Vec3::UnitZ()),
               turn = tipping.turn + tipping.by_lever * lever;
    const auto sinks_by = [&](const Vec3& arm) { return -height - arm.z() - turn.cross(arm).z(); };
    double deepest = -1.0;  // m
    for (int k = 0; k < found.count; ++k)
      deepest = std::max(deepest, sinks_by(found.contact[std::size_t(k)].arm));
    for (const Vec3& v : shape.hull.vertices) {
      const Vec3 arm = orientation * v;
      if (height + arm.z() >= 0.004) continue;
      EXPECT_LE(sinks_by(arm), deepest + 1.001e-3 * shape.radius) << i;
    }
    more += found.count > kMaxGroundContacts;
  }
  EXPECT_GT(more, 100);
}

// Of very many vertices, too, those are kept that span the widest support.
TEST(HullContacts, ADiscOfManyVerticesStandsWide) {
  for (const int sides : {120, 800}) {
    std::vector<Vec3> rim;
    for (int i = 0; i < sides; ++i)
      for (const double z : {-0.1, 0.1}) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        rim.push_back({std::cos(angle), std::sin(angle), z});
      }
    Shape disc;
    disc.hull = make_hull(rim);
    disc.radius = std::hypot(1.0, 0.1);
    std::int32_t hint = 0;
    const HullContacts found = find_hull_contacts(disc, Quat::Identity(), Vec3::UnitZ(), 0.1, 0.001, hint);
    ASSERT_EQ(found.count, 4);
    Vec3 sum = Vec3::Zero();
    for (const HullContact& c : found.contact) sum += c.arm;
    EXPECT_LT(sum.head<2>().norm(), 0.1) << sides;
    EXPECT_NEAR((found.contact[0].arm - found.contact[1].arm).norm(), 2.0, 0.01) << sides;
    EXPECT_NEAR((found.contact[2].arm - found.contact[3].arm).norm(), 2.0, 0.01) << sides;
  }
}

// Of a hull with many vertices only those are looked at that may be low (reference/hull/tip_map.h): to the
// bit what a look at all finds, for thin margins and thick ones, and whatever changes within a step.
TEST(HullContacts, AreTheSameWithALookAtAllVertices) {
  RandomStream random(64, 0, 0);
  const Shape shape = round_hull(random, {0.2, 0.3, 0.25});
  Shape with_map = shape;
  with_map.tips = TipMap(with_map.hull, with_map.radius);
  int several = 0;
  for (int i = 0; i < 4000; ++i) {
    const Quat orientation = random.orientation();
    const double height = random.uniform(0.1, 0.4), margin = random.uniform(-0.1, 0.06);
    GapChange change;
    if (i % 2) change = {random.uniform(-0.01, 0.01), 0.02 * random.direction()};
    std::int32_t hint = 0, other_hint = 0;
    const HullContacts all = find_hull_contacts(shape, orientation, Vec3::UnitZ(), height, margin, hint,
                                                change),
                       few = find_hull_contacts(with_map, orientation, Vec3::UnitZ(), height, margin,
                                                other_hint, change);
    ASSERT_EQ(all.count, few.count) << i;
    several += all.count == kMaxGroundContacts;
    for (std::size_t k = 0; k < std::size_t(all.count); ++k) {
      EXPECT_EQ(all.contact[k].vertex, few.contact[k].vertex) << i;
      EXPECT_EQ(all.contact[k].gap, few.contact[k].gap) << i;
    }
  }
  EXPECT_GT(several, 500);
}

}  // namespace
}  // namespace lodestone
