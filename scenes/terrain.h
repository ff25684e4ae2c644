// Ground that a scene describes instead of modelling it: a height field as a mesh, stairs as boxes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

/// A rectangle of equal cells, upright, sides along x and y; heights count from `middle_m`.
struct TerrainGrid {
  std::array<int, 2> cells{1, 1};
  std::array<double, 2> size_m{1, 1};
  Vec3 middle_m = Vec3::Zero();
};

/// height · cos(2π (x − crest x) / length x) · cos(2π (y − crest y) / length y): between −height and height;
/// x and y from the middle of the terrain.
struct Hill {
  double height_m = 0;
  std::array<double, 2> length_m{1, 1}, crest_m{0, 0};
};

/// The sum of `hills` at the corners of the cells: rows from the least y on, each from the least x on.
std::vector<double> heights_of(const TerrainGrid& grid, std::span<const Hill> hills);

/// Two triangles a cell, normals upwards. `heights` (m) as heights_of has them.
Mesh make_terrain(const TerrainGrid& grid, std::span<const double> heights);

/// They go up along x, before they are turned about the vertical through `position_m`, which is the middle of
/// the first step's lower front edge.
struct Stairs {
  int steps = 1;
  double rise_m = 0.2, run_m = 0.3, width_m = 1;
  Vec3 position_m = Vec3::Zero();
  double turn_deg = 0;
};

/// A box for each step, down to the foot of the stairs.
std::vector<GroundBox> make_stairs(const Stairs& stairs);

/// The box where it is, m.
Mesh make_ground_mesh(const GroundBox& box);

}  // namespace lodestone
