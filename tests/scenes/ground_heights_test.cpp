#include "scenes/ground_heights.h"

#include <gtest/gtest.h>

#include <numbers>

#include "scenes/terrain.h"

namespace lodestone {
namespace {

TEST(GroundHeights, ThePlaneIsHighestWhereNothingStandsOnIt) {
  const std::vector<SceneGround> ground{
      GroundPlane{.normal = Vec3(-0.6, 0, 0.8), .offset_m = 0.8},
      GroundBox{.sides_m = {2, 2, 2}, .position_m = {10, 0, 10}, .orientation = Quat::Identity()}};
  const GroundHeights heights(ground);
  EXPECT_NEAR(*heights.highest_under({0, 0, 50}, 0), 1.0, 1e-12);
  EXPECT_NEAR(*heights.highest_under({4, 7, 0}, 0), 4.0, 1e-12);
  EXPECT_NEAR(*heights.highest_under({4, 7, 0}, 0.4), 4.3, 1e-12)
      << "the slope's highest point under the disc";
  EXPECT_NEAR(*heights.highest_under({9.5, 0.5, 0}, 0), 11.0, 1e-12) << "the box's top";
  EXPECT_NEAR(*heights.highest_under({8.8, 0, 0}, 0.4), 11.0, 1e-12) << "its edge under the disc";
  EXPECT_LT(*heights.highest_under({8.5, 0, 0}, 0.4), 9.0);
}

// Against the plane that the corners of each triangle span.
TEST(GroundHeights, BetweenTheCornersOfATerrainItIsFlat) {
  const TerrainGrid grid{.cells = {7, 5}, .size_m = {7, 10}};
  std::vector<double> corners;
  for (int row = 0; row <= 5; ++row)
    for (int column = 0; column <= 7; ++column) corners.push_back(0.3 * column - 0.1 * row);
  const std::vector<SceneGround> ground{GroundMesh{.mesh = make_terrain(grid, corners)}};
  const GroundHeights heights(ground);
  for (double x = -3.5; x <= 3.5; x += 0.37)
    for (double y = -5; y <= 5; y += 0.41)
      EXPECT_NEAR(*heights.highest_under({x, y, 0}, 0), 0.3 * (x + 3.5) - 0.05 * (y + 5), 1e-9)
          << x << " " << y;
  EXPECT_FALSE(heights.highest_under({3.6, 0, 0}, 0));
  EXPECT_TRUE(heights.highest_under({3.6, 0, 0}, 0.2)) << "the disc reaches back over the edge";
}

TEST(GroundHeights, NothingLiesAcrossAnEdge) {
  const std::vector<SceneGround> ground{
      GroundPlane{},
      GroundBox{.sides_m = {2, 2, 0.2}, .position_m = {0, 0, 0.1}, .orientation = Quat::Identity()}};
  const GroundHeights heights(ground);
  const Shape brick = make_shape("brick", make_box({0.1, 0.2, 0.3}));
  const auto lay = [&](double x) { return heights.lay(brick, Quat::Identity(), 0.3, {x, 0.1, 0}); };
  EXPECT_NEAR(lay(0.7).value().position.z(), 0.35, 1e-9);
  EXPECT_FALSE(lay(0.95));
  EXPECT_FALSE(lay(1.05));
  EXPECT_NEAR(lay(1.3).value().position.z(), 0.15, 1e-9);
}

// On a slope every vertex of the side that is down touches it, and none is in it.
TEST(GroundHeights, ABoxLiesFlatOnASlope) {
  const Vec3 normal = Vec3(-0.2, 0.1, 1).normalized();
  const std::vector<SceneGround> ground{GroundPlane{.normal = normal, .offset_m = 0.5}};
  const GroundHeights heights(ground);
  const Shape brick = make_shape("brick", make_box({0.1, 0.2, 0.3}));
  const Quat on_its_side(
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()));  // the x axis down: 0.1 m high
  for (const double turn : {0.0, 0.7, 4.0}) {
    const RigidState state = heights.lay(brick, on_its_side, turn, {3, -2, 99}).value();
    EXPECT_TRUE(state.position.x() == 3 && state.position.y() == -2);
    EXPECT_NEAR(normal.dot(state.position) - 0.5, 0.05, 1e-9);
    EXPECT_NEAR(std::abs((state.orientation * Vec3::UnitX()).dot(normal)), 1.0, 1e-9);
  }
  const Quat apart = heights.lay(brick, on_its_side, 0.0, {3, -2, 0})->orientation.conjugate() *
                     heights.lay(brick, on_its_side, 0.7, {3, -2, 0})->orientation;
  EXPECT_NEAR(Eigen::AngleAxisd(apart).angle(), 0.7, 1e-9);
}

}  // namespace
}  // namespace lodestone
