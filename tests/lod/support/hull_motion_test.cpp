#include "lod/support/hull_motion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

bool stands(const Shape& shape, const Vec3& position, const Quat& orientation,
            std::span<const HalfSpace> planes) {
  StatisticalBody body;
  body.position = position, body.orientation = orientation;
  return stands_firmly(body, shape, planes);
}

TEST(StandsFirmly, OnAFaceNotOnAnEdgeOrACorner) {
  const auto cube = testing::box_shape({0.2, 0.2, 0.2});
  const HalfSpace floor{};
  const Quat on_edge = rotation_from_vector(Vec3(std::numbers::pi / 4, 0, 0)),
             on_corner = Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3(0, 0, -1));
  EXPECT_TRUE(stands(*cube, {0, 0, 0.1}, Quat::Identity(), {&floor, 1}));
  EXPECT_FALSE(stands(*cube, {0, 0, 0.1 * std::sqrt(2.0)}, on_edge, {&floor, 1}));
  EXPECT_FALSE(stands(*cube, {0, 0, cube->radius}, on_corner, {&floor, 1}));
  EXPECT_FALSE(stands(*cube, {0, 0, 0.12}, Quat::Identity(), {&floor, 1}));  // in the air
  EXPECT_FALSE(stands(*cube, {0, 0, 0.1}, Quat::Identity(), {}));
}

// Leaning on a wall it stands on an edge and touches with another.
TEST(StandsFirmly, BetweenFloorAndWallItMayLean) {
  const auto cube = testing::box_shape({0.2, 0.2, 0.2});
  const Quat leaning = rotation_from_vector(Vec3(0, std::numbers::pi / 4, 0));
  const double half = 0.1 * std::sqrt(2.0);
  const HalfSpace planes[] = {{}, {Vec3::UnitX(), -half}};
  EXPECT_TRUE(stands(*cube, {0, 0, half}, leaning, planes));
}

TEST(StandsFirmly, ABallAlwaysDoes) {
  EXPECT_TRUE(stands(make_sphere_shape(0.1), {0, 0, 0.1}, Quat::Identity(), {}));
}

}  // namespace
}  // namespace lodestone
