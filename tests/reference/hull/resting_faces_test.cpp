#include "reference/hull/resting_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "reference/shape.h"

namespace lodestone {
namespace {

constexpr double kTwelveDegrees = 12.0 * std::numbers::pi / 180.0;

const Shape& box() {
  static const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  return shape;
}

TEST(RestingFaces, BoxHasSixWithPassesOverItsEdges) {
  const RestingFaces resting(box().hull);
  ASSERT_EQ(resting.faces().size(), 6u);
  const double heights[] = {0.1, 0.1, 0.15, 0.15, 0.2, 0.2};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(resting.faces()[i].height, heights[i], 1e-12);
  // From the other large face and the middle ones the way down leads over the long edges; from the small ones
  // over the middle edges.
  EXPECT_TRUE(std::isinf(resting.faces()[0].pass));
  for (const int i : {1, 2, 3}) EXPECT_NEAR(resting.faces()[i].pass, std::hypot(0.1, 0.15), 1e-12);
  for (const int i : {4, 5}) EXPECT_NEAR(resting.faces()[i].pass, std::hypot(0.1, 0.2), 1e-12);
}

// A box let down tips onto the face whose solid angle, seen from the centre, the downward direction lies in.
TEST(RestingFaces, BoxTipsOntoTheFaceBelowItsCentre) {
  const RestingFaces resting(box().hull);
  const Vec3 half(0.1, 0.15, 0.2);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    RandomStream random(1, i, 0);
    const Vec3 up = random.direction();
    int axis = 0;
    up.cwiseAbs().cwiseQuotient(half).maxCoeff(&axis);
    Vec3 expected = Vec3::Zero();
    expected[axis] = up[axis] > 0.0 ? 1.0 : -1.0;
    EXPECT_GT(resting.faces()[resting.find_quasistatic(up)].normal.dot(expected), 0.999999) << up.transpose();
  }
}

TEST(RestingFaces, EnergyDecidesOnceItDoesNotReachOverAPass) {
  const RestingFaces resting(box().hull);
  const Vec3 tilted = Vec3(1.0, 0.2, 0.1).normalized();
  const double height = -tilted.dot(box().hull.vertices[find_support(box().hull, -tilted)]),
               pass = std::hypot(0.1, 0.15);
  ASSERT_LT(height, pass);
  EXPECT_GE(resting.find_certain(tilted, pass - 1e-6, kTwelveDegrees), 0);
  EXPECT_GT(resting.faces()[resting.find_certain(tilted, height + 1e-6, kTwelveDegrees)].normal.x(),
            0.999999);
  EXPECT_EQ(resting.find_certain(tilted, pass + 1e-6, kTwelveDegrees), -1);
  EXPECT_EQ(resting.find_certain(tilted, 1.0, kTwelveDegrees), -1);
  EXPECT_EQ(resting.find_certain(tilted, 1.0, std::numbers::pi),
            resting.find_certain(Vec3::UnitY(), 1.0, std::numbers::pi));  // the lowest of all
}

TEST(RestingFaces, LStandsOnTheSlantedSideOfItsHull) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1));
  const RestingFaces resting(l.hull);
  int slanted = 0;
  for (const RestingFace& face : resting.faces())
    slanted += std::abs(face.normal.x()) > 0.1 && std::abs(face.normal.y()) > 0.1;
  EXPECT_EQ(slanted, 1);
  EXPECT_EQ(resting.faces().size(), 6u);
}

// On its small face (.2 × .3 m, .2 m below its centre) the box stands on slopes of 26.6° and 36.9°, across
// its sides.
TEST(RestingFaces, AFaceHoldsWhatPullsWithinItsEdges) {
  const RestingFaces resting(box().hull);
  const Vec3 up = Vec3::UnitZ();
  const auto pull = [](double degrees, const Vec3& towards) {
    const double angle = degrees * std::numbers::pi / 180.0;
    return Vec3(std::sin(angle) * towards - std::cos(angle) * Vec3::UnitZ());
  };
  EXPECT_TRUE(resting.holds(up, pull(0.0, Vec3::UnitX())));
  EXPECT_TRUE(resting.holds(up, 3.0 * pull(26.0, Vec3::UnitX())));
  EXPECT_FALSE(resting.holds(up, pull(27.0, Vec3::UnitX())));
  EXPECT_TRUE(resting.holds(up, pull(36.0, Vec3::UnitY())));
  EXPECT_FALSE(resting.holds(up, pull(38.0, Vec3::UnitY())));
  EXPECT_FALSE(resting.holds(up, -pull(0.0, Vec3::UnitX())));
  EXPECT_FALSE(resting.holds(up, Vec3::Zero()));
}

}  // namespace
}  // namespace lodestone
