#include "lod/tables/hull_heights.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

struct Maps {
  explicit Maps(const Shape& shape) { sample_hull_heights(shape, heights, reaches); }
  static double read(const std::vector<float>& map, const Vec3& direction) {
    return double(
        read_hull_height(map.data(), 0, {float(direction.x()), float(direction.y()), float(direction.z())}));
  }
  std::vector<float> heights = std::vector<float>(kHullHeights), reaches = heights;
};

TEST(HullHeights, OfABallAreItsRadius) {
  const Maps maps(make_sphere_shape(0.3));
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FLOAT_EQ(float(Maps::read(maps.heights, random.direction())), 0.3f);
    EXPECT_FLOAT_EQ(float(Maps::read(maps.reaches, random.direction())), 0.3f);
  }
}

// Of a box the support function is Σ |n_i| a_i/2: exact along the axes, elsewhere as near as 5° allow.
TEST(HullHeights, OfABoxAreItsSupportFunction) {
  const Vec3 sides(0.2, 0.3, 0.4);
  const Maps maps(*testing::box_shape(sides));
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_NEAR(Maps::read(maps.heights, sign * Vec3::Unit(axis)), 0.5 * sides[axis], 2e-3) << axis;
      EXPECT_NEAR(Maps::read(maps.reaches, sign * Vec3::Unit(axis)), 0.5 * sides[axis], 2e-3) << axis;
    }
  RandomStream random(2, 0, 0);
  double worst = 0.0;
  for (int i = 0; i < 2'000; ++i) {
    const Vec3 n = random.direction();
    worst = std::max(worst, std::abs(Maps::read(maps.heights, n) - 0.5 * n.cwiseAbs().dot(sides)));
    EXPECT_NEAR(Maps::read(maps.heights, 7.0 * n), Maps::read(maps.heights, n), 1e-6);  // of any length
  }
  EXPECT_LT(worst, 0.012);  // 4 % of the greatest
}

// .35 of the way from the support height to where the line leaves the hull: of a cube's corner both are √3/2.
TEST(HullHeights, WhatKeepsOthersAwayLiesBetweenSurfaceAndSupport) {
  const Maps cube(*testing::box_shape({1, 1, 1}));
  EXPECT_NEAR(Maps::read(cube.reaches, Vec3(1, 1, 1)), std::sqrt(0.75), 0.02);
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec3 n = random.direction();
    const double support = 0.5 * n.lpNorm<1>(), surface = 0.5 / n.lpNorm<Eigen::Infinity>();
    EXPECT_NEAR(Maps::read(cube.reaches, n), support + 0.35 * (surface - support), 0.03);
  }
}

// An L fills .52 of its hull or so: it lets others nearer by the cube root of that.
TEST(HullHeights, ConcaveShapesLetOthersNearer) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1));
  const Maps maps(l);
  double six_volumes = 0.0;
  for (std::size_t face = 0; face < l.hull.faces.size(); ++face)
    six_volumes += l.hull.face_normal(int(face)).dot(l.hull.vertices[std::size_t(l.hull.faces[face][0])]);
  const double solid = std::pow(6.0 * l.volume / six_volumes, 1.0 / 3.0);
  ASSERT_LT(solid, 0.95);
  EXPECT_NEAR(Maps::read(maps.heights, Vec3::UnitZ()), 0.05, 1e-3);
  EXPECT_NEAR(Maps::read(maps.reaches, Vec3::UnitZ()), solid * 0.05, 2e-3);
}

// A fifth of how far from the line through the centre of mass the lowest corner lies, on average: of a box
// that corner is where the direction's signs point.
TEST(RollingLever, IsAFifthOfTheLowestCornersMeanOffset) {
  for (const Vec3& sides : {Vec3(0.2, 0.2, 0.2), Vec3(0.2, 0.3, 0.4), Vec3(0.1, 0.1, 1.0)}) {
    RandomStream random(4, 0, 0);
    constexpr int kDirections = 100'000;
    double sum = 0.0;
    for (int i = 0; i < kDirections; ++i) {
      const Vec3 n = random.direction(), corner = 0.5 * sides.cwiseProduct(n.cwiseSign());
      sum += (corner - corner.dot(n) * n).norm() / kDirections;
    }
    const double lever = find_rolling_lever(*testing::box_shape(sides));
    EXPECT_NEAR(lever, 0.2 * sum, 0.03 * lever);
  }
}

TEST(RollingLever, ABallHasNone) { EXPECT_EQ(find_rolling_lever(make_sphere_shape(0.3)), 0.0); }

// Of 320 faces less than of six, over R.
TEST(RollingLever, IsLessTheRounderAShapeIs) {
  const Shape cube = *testing::box_shape({0.2, 0.2, 0.2});
  const Shape round = make_shape("round", make_sphere(0.1, 2));
  EXPECT_LT(find_rolling_lever(round) / round.radius, 0.3 * find_rolling_lever(cube) / cube.radius);
  EXPECT_GT(find_rolling_lever(round), 0.0);
}

}  // namespace
}  // namespace lodestone
