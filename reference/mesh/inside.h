// What lies inside a mesh, by counting how often vertical lines cross its surface.
#pragma once

#include <vector>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// How often the closed surface `mesh` winds round `point`: 0 outside, 1 inside a solid with outward faces, 0
/// inside its cavities, −1 inside a surface that is inside out. Without meaning for an open mesh or a point
/// on the surface.
int winding_number(const Mesh& mesh, const Vec3& point);

/// The centres of the cells of a cubic grid over the bounding box of `mesh` (closed, outward faces) that lie
/// inside it. `cell_m` is the cells' side; the order is by x, y, z.
std::vector<Vec3> find_inside_points(const Mesh& mesh, double cell_m);

}  // namespace lodestone
