#include "lod/contact/solid_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/prism.h"

namespace lodestone {
namespace {

constexpr double kPointStep = 0.01, kCarries = 4e-4;  // s, m
constexpr double kRadius = 0.12, kLength = 0.3;       // m, of the barrel

class SolidPointsTest : public ::testing::Test {
 protected:
  static Shape cube() { return make_shape("cube", make_box({0.2, 0.2, 0.2})); }
  void find(const Shape& shape, const StatisticalBody& body) {
    const BodyKind kind = make_body_kind(std::make_shared<const Shape>(shape));
    find_solid_points(body, kind, ground_, kPointStep, kCarries, found_);
  }
  // A barrel that lies along y, an edge below, and comes along x.
  static StatisticalBody barrel_at(const Vec3& place) {
    StatisticalBody body;
    body.position = place;
    body.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX());
    body.velocity = {1.5, 0, 0};
    return body;
  }

  Ground ground_;
  SolidPoints found_;
};

// Of four boxes of one height, whose edges are none to it.
TEST_F(SolidPointsTest, OverFlushBoxesItStandsOnItsOwnVertices) {
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) ground_.add_box({1, 1, 1}, {x, y, -0.5}, Quat::Identity(), 3);
  StatisticalBody body;
  body.position = {0.02, 0.03, 0.1};
  body.velocity = {1, 0, 0};
  find(cube(), body);
  ASSERT_EQ(found_.points.size(), 4U);
  for (const SolidPoint& p : found_.points) {
    EXPECT_GE(p.vertex, 0);
    EXPECT_NEAR(p.plane.normal.z(), 1.0, 1e-9);
    EXPECT_NEAR(p.plane.height_of(p.point), 0.0, 1e-9);
    EXPECT_EQ(p.plane.material, 3);
  }
  EXPECT_EQ(found_.until, kPointStep);
}

// Not only the widest of what is near, nor a mean of its sides.
TEST_F(SolidPointsTest, TheEdgeThatARoundBodyRollsOnIsNearest) {
  ground_.add_box({4, 0.36, 1}, {0, 0, -0.5}, Quat::Identity(), 0);  // its sides are in reach
  const auto barrel = testing::make_prism(24, kRadius, kLength);
  const double lowest = kRadius - 1e-4;
  find(*barrel, barrel_at({0, 0, lowest}));
  ASSERT_GE(found_.points.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    const SolidPoint& p = found_.points[std::size_t(i)];
    EXPECT_NEAR(p.plane.height_of(p.point), lowest - kRadius, 1e-9);
    EXPECT_NEAR(std::abs(p.point.y()), 0.5 * kLength, 1e-9);
  }
}

TEST_F(SolidPointsTest, WhatIsInsideLeavesThroughTheNearestFace) {
  ground_.add_box({1, 1, 1}, {0.5, 0, -0.5}, Quat::Identity(), 0);  // from x = 0 on, z < 0
  StatisticalBody body;
  body.position = {-0.099, 0, 0.08};  // a millimetre in it, and two centimetres below its upper side
  find(cube(), body);
  ASSERT_FALSE(found_.points.empty());
  for (const SolidPoint& p : found_.points) EXPECT_LT(p.plane.normal.x(), -0.999);
}

// It hangs over the edge, below the upper side and beyond the other one.
TEST_F(SolidPointsTest, AcrossAnEdgeThatItDoesNotTouchYetNothingHoldsIt) {
  ground_.add_box({1, 4, 1}, {0.5, 0, -0.5}, Quat::Identity(), 0);
  const auto barrel = testing::make_prism(24, kRadius, kLength);
  StatisticalBody body = barrel_at({-0.07, 0, 0.107});
  body.velocity = {0.8, 0, -1};
  find(*barrel, body);
  for (const SolidPoint& p : found_.points) EXPECT_GT(p.least_gap, 0.0);
  EXPECT_GT(found_.until, 0.3 * kPointStep);
  EXPECT_LT(found_.until, 0.9 * kPointStep);
  body.position += 0.008 * Vec3(1, 0, -1).normalized();
  find(*barrel, body);
  ASSERT_FALSE(found_.points.empty());
  EXPECT_FALSE(found_.points[0].along_face);
}

}  // namespace
}  // namespace lodestone
