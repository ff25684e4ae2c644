#include "lod/tables/hull_heights.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/random.h"
#include "tests/four_legged.h"
#include "tests/lod/tables/hull_maps.h"
#include "tests/prism.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using testing::Maps;

TEST(HullHeights, OfABallAreItsRadius) {
  const Maps maps(make_sphere_shape(0.3));
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FLOAT_EQ(float(Maps::read(maps.heights, random.direction())), 0.3f);
    EXPECT_FLOAT_EQ(float(Maps::read(maps.pair_heights, random.direction())), 0.3f);
  }
}

// Of a box the support function is Σ |n_i| a_i/2: exact along the axes, elsewhere as near as 5° allow.
TEST(HullHeights, OfABoxAreItsSupportFunction) {
  const Vec3 sides(0.2, 0.3, 0.4);
  const Maps maps(*testing::box_shape(sides));
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_NEAR(Maps::read(maps.heights, sign * Vec3::Unit(axis)), 0.5 * sides[axis], 2e-3) << axis;
      EXPECT_NEAR(Maps::read(maps.pair_heights, sign * Vec3::Unit(axis)), 0.5 * sides[axis], 2e-3) << axis;
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

// A cube's face through which a direction leaves it is that of its largest component.
TEST(HullHeights, TheFaceIsWhereTheDirectionLeavesTheHull) {
  const Maps cube(*testing::box_shape({1, 1, 1}));
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec3 n = random.direction();
    int axis = 0;
    const double largest = n.cwiseAbs().maxCoeff(&axis);
    if (largest - (n - n[axis] * Vec3::Unit(axis)).cwiseAbs().maxCoeff() < 0.2) continue;  // near an edge
    const lane::F3 direction{float(n.x()), float(n.y()), float(n.z())};
    const lane::Row& face = cube.faces[std::size_t(lane::place_in_map(direction).nearest)];
    const Vec3 normal(double(face.x), double(face.y), double(face.z));
    EXPECT_LT((normal - std::copysign(1.0, n[axis]) * Vec3::Unit(axis)).norm(), 1e-6);
    EXPECT_FLOAT_EQ(face.w, 0.5f);
  }
}

TEST(HullHeights, WhatIsNoNumberIsReadWithinTheMap) {
  const float none = std::numeric_limits<float>::quiet_NaN(), far = std::numeric_limits<float>::infinity();
  for (const lane::F3& direction : {lane::F3{none, none, none}, lane::F3{0, none, 1}, lane::F3{far, 0, 0},
                                    lane::F3{0, 0, 0}, lane::F3{0, 0, -1}, lane::F3{-1, -1, 0}}) {
    const lane::MapPlace place = lane::place_in_map(direction);
    for (const int at : {place.first, place.first + kHullHeightSide + 2, place.nearest}) {
      EXPECT_GE(at, 0);
      EXPECT_LT(at, kHullHeights);
    }
  }
}

// An L fills .72 of its hull, and its mass lies as far out as that of a hull 1.06 times as large; the bunny
// .60, with its mass within; a frame's bars .28, which count as .84.
TEST(HullHeights, ConcaveShapesLetOthersNearer) {
  const auto size_of = [](const Shape& shape, const Vec3& along) {
    const Maps maps(shape);
    return Maps::read(maps.pair_heights, along) / Maps::read(maps.heights, along);
  };
  EXPECT_NEAR(size_of(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)), Vec3::UnitZ()), 0.949, 1e-3);
  EXPECT_NEAR(size_of(make_bunny_shape(0.2), Vec3::UnitX()), 0.845, 1e-3);
  EXPECT_NEAR(size_of(make_shape("four-legged", testing::make_four_legged()), Vec3::UnitZ()), 0.84, 1e-6);
}

double lever_about(const Shape& shape, const Vec3& axis) {
  return std::sqrt(axis.dot(find_rolling_levers(shape) * axis));
}

double mean_lever(const Shape& shape) { return std::sqrt(find_rolling_levers(shape).trace() / 3.0); }

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
    const double lever = mean_lever(*testing::box_shape(sides));
    EXPECT_NEAR(lever, 0.2 * sum, 0.03 * lever);
  }
}

TEST(RollingLever, ABallHasNone) { EXPECT_EQ(mean_lever(make_sphere_shape(0.3)), 0.0); }

TEST(RollingLever, OfACubeIsTheSameAboutAllAxes) {
  const Shape cube = *testing::box_shape({0.2, 0.2, 0.2});
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 20; ++i)
    EXPECT_NEAR(lever_about(cube, random.direction()), mean_lever(cube), 0.03 * mean_lever(cube));
}

// Its faces are half a side's width beside the middle at most.
TEST(RollingLever, OfALogIsSmallAboutItsAxis) {
  for (const int sides : {12, 24, 40}) {
    const Shape log = *testing::make_prism(sides, 0.2, 0.6);  // about z
    const double over_end = lever_about(log, Vec3::UnitX());
    EXPECT_LT(lever_about(log, Vec3::UnitZ()), 2.5 / sides * over_end) << sides;
    EXPECT_NEAR(lever_about(log, Vec3::UnitY()), over_end, 0.03 * over_end) << sides;
  }
}

// Of 320 faces less than of six, over R.
TEST(RollingLever, IsLessTheRounderAShapeIs) {
  const Shape cube = *testing::box_shape({0.2, 0.2, 0.2});
  const Shape round = make_shape("round", make_sphere(0.1, 2));
  EXPECT_LT(mean_lever(round) / round.radius, 0.3 * mean_lever(cube) / cube.radius);
  EXPECT_GT(mean_lever(round), 0.0);
}

}  // namespace
}  // namespace lodestone
