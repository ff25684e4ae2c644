// Convex pieces of a concave solid, where a few are exact: letters, chairs, stairs. The planes of the faces
// that lie within the hull cut it into convex cells, each wholly inside the solid or outside; cells inside
// are then joined into the largest convex unions. Pieces overlap, so that few of their faces lie inside the
// solid. (Nef-style cell arrangement; compare Chazelle, Convex Partitions of Polyhedra, 1984, whose pieces do
// not overlap.)
#pragma once

#include <vector>

#include "reference/hull/hull.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

/// Hulls in the frame of `mesh` (closed, outward faces; `hull` its own) whose union is the solid: one where
/// it is convex. None where more than 24 planes cut into the hull, as on a curved concave surface, where the
/// pieces would be more than 16, or where their volume misses the mesh's by more than 1e-6 of it.
std::vector<Hull> find_convex_pieces(const Mesh& mesh, const Hull& hull);

}  // namespace lodestone
