// Meshes of solids made by code: closed, each face counter-clockwise seen from outside; lengths in m.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// About the z axis: `around` sections of `across` corners each.
Mesh make_torus(double ring_radius, double tube_radius, int around, int across);

/// A prism along z whose outline's corners have these distances from the axis, at even angles: a regular
/// polygon, a star, a gear. At least three.
Mesh make_star_prism(std::span<const double> radii, double thickness);

/// Between two regular polygons of `corners` corners, along z.
Mesh make_frustum(int corners, double bottom_radius, double top_radius, double height);

/// The convex hull of `points`.
Mesh make_hull_mesh(std::span<const Vec3> points);

/// The convex hull of `points` random points in an ellipsoid with these semi-axes.
Mesh make_random_hull(int points, const Vec3& semi_axes, std::uint64_t seed);

/// Boxes on a grid, some of which are filled: letters, furniture. No two filled cells may meet in an edge or
/// corner alone.
struct CellSolid {
  std::vector<double> x, y, z;  ///< sides of the columns, rows and layers
  /// From the lowest; of each its rows, that of the greatest y first; '#' is filled.
  std::vector<std::vector<std::string>> layers;
};
Mesh make_cell_mesh(const CellSolid& solid);

}  // namespace lodestone
