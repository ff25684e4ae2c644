// A geom of the caller's as convex solids. What is round is met as a polyhedron, off by less than a
// thousandth of its radius on average.
#pragma once

#include "lod/ground/ground_solids.h"
#include "reference/ode/geom_shape.h"

namespace lodestone {

/// The corners of the convex solid that `geom` is; empty for a trimesh and what is no solid.
std::vector<Vec3> corners_of(const GeomShape& geom);

/// The faces of a trimesh, its corners that coincide made one.
Mesh mesh_of(const GeomShape& geom);

/// In the geom's own frame; none for what cannot be read (planes, height fields, other classes) and for what
/// is flat.
GroundSolids solids_of(const GeomShape& geom);

}  // namespace lodestone
