#include "scenes/terrain.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lodestone {
namespace {

TEST(Terrain, ListedHeightsStandAtTheCornersAndFacesLookUp) {
  const TerrainGrid grid{.cells = {2, 1}, .size_m = {4, 3}, .middle_m = {10, 20, 5}};
  const Mesh mesh = make_terrain(grid, std::vector<double>{0, 1, 2, 3, 4, 5});
  ASSERT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.vertices[0], Vec3(8, 18.5, 5));
  EXPECT_EQ(mesh.vertices[2], Vec3(12, 18.5, 7));
  EXPECT_EQ(mesh.vertices[4], Vec3(10, 21.5, 9));
  ASSERT_EQ(mesh.faces.size(), 4u);
  for (const auto& f : mesh.faces) {
    const Vec3 a = mesh.vertices[std::size_t(f[0])], b = mesh.vertices[std::size_t(f[1])],
               c = mesh.vertices[std::size_t(f[2])];
    EXPECT_NEAR((b - a).cross(c - a).z(), 2.0 * 3.0, 1e-12)
        << "every triangle is half a cell, counter-clockwise from above";
  }
}

TEST(Terrain, HillsAddUp) {
  const TerrainGrid grid{.cells = {4, 2}, .size_m = {8, 4}};
  const std::vector<Hill> hills{{.height_m = 0.5, .length_m = {8, 16}},
                                {.height_m = 0.25, .length_m = {4, 4}, .crest_m = {1, 0}}};
  const std::vector<double> heights = heights_of(grid, hills);
  ASSERT_EQ(heights.size(), 15u);
  EXPECT_NEAR(heights[7], 0.5 + 0.25 * std::cos(std::numbers::pi / 2), 1e-12) << "the middle";
  EXPECT_NEAR(heights[2], 0.5 * std::cos(std::numbers::pi / 4), 1e-12) << "at 0, -2";
  EXPECT_NEAR(heights[5], -0.5, 1e-12) << "at -4, 0";
}

TEST(Terrain, StairsGoUpToWhereTheyAreTurned) {
  const std::vector<GroundBox> boxes = make_stairs(
      {.steps = 3, .rise_m = 0.2, .run_m = 0.3, .width_m = 2, .position_m = {1, 2, 3}, .turn_deg = 90});
  ASSERT_EQ(boxes.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const GroundBox& box = boxes[std::size_t(i)];
    EXPECT_TRUE(box.sides_m.isApprox(Vec3(0.3, 2, 0.2 * (i + 1))));
    EXPECT_TRUE(box.position_m.isApprox(Vec3(1, 2 + 0.3 * (i + 0.5), 3 + 0.1 * (i + 1))))
        << box.position_m.transpose();
    EXPECT_TRUE((box.orientation * Vec3::UnitX()).isApprox(Vec3::UnitY()));
  }
}

}  // namespace
}  // namespace lodestone
