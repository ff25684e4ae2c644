#include "lod/contact/contact_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

namespace lodestone {
namespace {

using Corners = std::vector<Vec3>;

// A square of side 2 about (x, y) at height z; turned by 45 degrees where `turned`.
Corners square_at(double x, double y, double z, bool turned = false) {
  const double r = std::sqrt(2.0);
  if (turned) return Corners({{x + r, y, z}, {x, y + r, z}, {x - r, y, z}, {x, y - r, z}});
  return Corners({{x - 1, y - 1, z}, {x + 1, y - 1, z}, {x - 1, y + 1, z}, {x + 1, y + 1, z}});
}

std::vector<Vec3> points_of(const Manifold& manifold) {
  std::vector<Vec3> points;
  for (int i = 0; i < manifold.count; ++i) points.push_back(manifold.points[std::size_t(i)].point);
  return points;
}

bool has_point(const Manifold& manifold, const Vec3& point) {
  return std::ranges::any_of(points_of(manifold), [&](const Vec3& p) { return (p - point).norm() < 1e-5; });
}

constexpr double kAnyGap = -1e9;

TEST(ContactManifold, TwoFacesTouchInTheirOverlap) {
  const Manifold m = find_manifold(square_at(1, 1, 0.2), square_at(0, 0, 0.1), Vec3::UnitZ(), kAnyGap);
  ASSERT_EQ(m.count, 4);
  for (const Vec3& corner : {Vec3(0, 0, 0.15), Vec3(1, 0, 0.15), Vec3(1, 1, 0.15), Vec3(0, 1, 0.15)})
    EXPECT_TRUE(has_point(m, corner)) << corner.transpose();
  for (int i = 0; i < m.count; ++i) EXPECT_NEAR(m.points[std::size_t(i)].gap, 0.1, 1e-12);
}

// An octagon, of which four corners are kept, that go round its middle.
TEST(ContactManifold, KeepsFourPointsOfWideSupport) {
  const Manifold m = find_manifold(square_at(0, 0, 0.0, true), square_at(0, 0, 0.0), Vec3::UnitZ(), kAnyGap);
  ASSERT_EQ(m.count, 4);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point : points_of(m)) {
    sum += point;
    EXPECT_NEAR(point.head<2>().cwiseAbs().maxCoeff(), 1.0, 1e-5);
  }
  EXPECT_LT(sum.norm(), 1.0);
}

TEST(ContactManifold, AnEdgeOnAFaceTouchesInTwoPointsWithTheirOwnGaps) {
  const Corners edge = Corners({{-0.5, 0, 0.0}, {0.5, 0, 0.2}});
  const Manifold m = find_manifold(edge, square_at(0, 0, 0), Vec3::UnitZ(), kAnyGap);
  ASSERT_EQ(m.count, 2);
  EXPECT_TRUE(has_point(m, {-0.5, 0, 0.0}));
  EXPECT_TRUE(has_point(m, {0.5, 0, 0.1}));
  EXPECT_NEAR(std::max(m.points[0].gap, m.points[1].gap), 0.2, 1e-12);
}

TEST(ContactManifold, CrossingEdgesTouchInOnePoint) {
  const Corners along_x = {{-1, 0.25, 0.3}, {1, 0.25, 0.3}}, along_y = {{0.5, -1, 0}, {0.5, 1, 0}};
  const Manifold m = find_manifold(along_x, along_y, Vec3::UnitZ(), kAnyGap);
  ASSERT_EQ(m.count, 1);
  EXPECT_LT((m.points[0].point - Vec3(0.5, 0.25, 0.15)).norm(), 1e-9);
  EXPECT_NEAR(m.points[0].gap, 0.3, 1e-12);
}

TEST(ContactManifold, WhatDoesNotOverlapTouchesNowhere) {
  EXPECT_EQ(find_manifold(square_at(5, 0, 0), square_at(0, 0, 0), Vec3::UnitZ(), kAnyGap).count, 0);
  EXPECT_EQ(find_manifold(Corners({{3, 0, 0}}), square_at(0, 0, 0), Vec3::UnitZ(), kAnyGap).count, 0);
}

TEST(ContactManifold, GapsAreNoLessThanTheLeast) {
  const Manifold m = find_manifold(square_at(0, 0, -0.5), square_at(0, 0, 0), Vec3::UnitZ(), -0.1);
  ASSERT_EQ(m.count, 4);
  for (int i = 0; i < m.count; ++i) EXPECT_EQ(m.points[std::size_t(i)].gap, -0.1);
}

// Of a round plate's four widest corners alone the square would be wholly outside.
TEST(ContactManifold, AFaceOfManyCornersHoldsWhatIsNearItsRim) {
  for (const int sides : {5, 6, 8, 24, kMostCorners}) {
    Corners plate, cup;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / sides;
      plate.push_back(4.0 * Vec3(std::cos(angle), std::sin(angle), 0.0));
    }
    const double rim = 4.0 * std::cos(std::numbers::pi / sides) - 0.3;  // of the middle of a side
    for (int i = 0; i < sides; ++i) {
      const Quat turn(Eigen::AngleAxisd(2.0 * std::numbers::pi * (i + 1) / sides, Vec3::UnitZ()));
      cup.clear();
      for (const Vec3& corner : square_at(0, 0, 0.1))
        cup.push_back(turn * (0.25 * corner + rim * Vec3::UnitX()));
      const Manifold m = find_manifold(cup, plate, Vec3::UnitZ(), kAnyGap);
      ASSERT_EQ(m.count, 4) << sides;
      for (const Vec3& corner : cup) EXPECT_TRUE(has_point(m, {corner.x(), corner.y(), 0.0125})) << sides;
    }
  }
}

// The same picture, whichever way the normal looks.
TEST(ContactManifold, TurnsWithTheNormal) {
  const Quat turn = Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()));
  Corners upper = square_at(1, 1, 0.2), lower = square_at(0, 0, 0.1);
  for (Corners* corners : {&upper, &lower})
    for (Vec3& corner : *corners) corner = turn * corner;
  const Manifold m = find_manifold(upper, lower, turn * Vec3::UnitZ(), kAnyGap);
  ASSERT_EQ(m.count, 4);
  for (const Vec3& corner : {Vec3(0, 0, 0.15), Vec3(1, 0, 0.15), Vec3(1, 1, 0.15), Vec3(0, 1, 0.15)})
    EXPECT_TRUE(has_point(m, turn * corner));
}

TEST(ContactManifold, JoinedPatchesKeepTheirOutermostPointsAndGaps) {
  Manifold left, right;
  for (const Vec3& p : {Vec3(-2, -1, 0), Vec3(-2, 1, 0), Vec3(-0.5, 0, 0)})
    left.points[std::size_t(left.count++)] = {p, 0.01};
  for (const Vec3& p : {Vec3(2, -1, 0), Vec3(2, 1, 0), Vec3(0.5, 0, 0)})
    right.points[std::size_t(right.count++)] = {p, 0.02};
  const Manifold m = join_manifolds(left, right, Vec3::UnitZ());
  ASSERT_EQ(m.count, 4);
  for (const Vec3& corner : {Vec3(-2, -1, 0), Vec3(-2, 1, 0), Vec3(2, -1, 0), Vec3(2, 1, 0)})
    EXPECT_TRUE(has_point(m, corner)) << corner.transpose();
  for (int i = 0; i < m.count; ++i)
    EXPECT_EQ(m.points[std::size_t(i)].gap, m.points[std::size_t(i)].point.x() < 0 ? 0.01 : 0.02);
}

}  // namespace
}  // namespace lodestone
