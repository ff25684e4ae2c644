#include "scenes/terrain.h"

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

/// Of a corner from the middle of the grid, along one axis.
double place_along(const TerrainGrid& grid, int axis, int corner) {
  return grid.size_m[std::size_t(axis)] * (double(corner) / grid.cells[std::size_t(axis)] - 0.5);
}

double height_at(std::span<const Hill> hills, double x, double y) {
  double height = 0;
  for (const Hill& hill : hills)
    height += hill.height_m * std::cos(2 * std::numbers::pi * (x - hill.crest_m[0]) / hill.length_m[0]) *
              std::cos(2 * std::numbers::pi * (y - hill.crest_m[1]) / hill.length_m[1]);
  return height;
}

}  // namespace

std::vector<double> heights_of(const TerrainGrid& grid, std::span<const Hill> hills) {
  std::vector<double> heights;
  for (int row = 0; row <= grid.cells[1]; ++row)
    for (int column = 0; column <= grid.cells[0]; ++column)
      heights.push_back(height_at(hills, place_along(grid, 0, column), place_along(grid, 1, row)));
  return heights;
}

Mesh make_terrain(const TerrainGrid& grid, std::span<const double> heights) {
  const int columns = grid.cells[0] + 1;
  Mesh mesh;
  for (int row = 0; row <= grid.cells[1]; ++row)
    for (int column = 0; column < columns; ++column)
      mesh.vertices.push_back(grid.middle_m + Vec3(place_along(grid, 0, column), place_along(grid, 1, row),
                                                   heights[std::size_t(row * columns + column)]));
  for (int row = 0; row < grid.cells[1]; ++row)
    for (int column = 0; column < grid.cells[0]; ++column) {
      const int corner = row * columns + column, above = corner + columns;
      mesh.faces.push_back({corner, corner + 1, above + 1});
      mesh.faces.push_back({corner, above + 1, above});
    }
  return mesh;
}

std::vector<GroundBox> make_stairs(const Stairs& stairs) {
  const Quat turn(Eigen::AngleAxisd(stairs.turn_deg * std::numbers::pi / 180, Vec3::UnitZ()));
  std::vector<GroundBox> boxes;
  for (int step = 0; step < stairs.steps; ++step) {
    const double height = (step + 1) * stairs.rise_m;
    const Vec3 middle((step + 0.5) * stairs.run_m, 0, 0.5 * height);
    boxes.push_back({.sides_m = {stairs.run_m, stairs.width_m, height},
                     .position_m = stairs.position_m + turn * middle,
                     .orientation = turn});
  }
  return boxes;
}

Mesh make_ground_mesh(const GroundBox& box) {
  Mesh mesh = make_box(box.sides_m);
  for (Vec3& vertex : mesh.vertices) vertex = box.position_m + box.orientation * vertex;
  return mesh;
}

}  // namespace lodestone
