// Simplifying a closed mesh so that it surely stays closed, for the last stretch where meshoptimizer pinches
// or tears thin parts: half-edge collapse by quadric error (Garland and Heckbert, Surface simplification
// using quadric error metrics, 1997) under the link condition (Dey et al., Topology preserving edge
// contraction, 1999).
#pragma once

#include "reference/mesh/mesh.h"

namespace lodestone {

/// `mesh` (welded, closed) with `faces` faces, or as few above that as can be reached. Its vertices are some
/// of `mesh`'s. `error`, when given, receives the greatest root mean square distance of a collapsed vertex's
/// planes, in the mesh's units.
Mesh collapse_edges(const Mesh& mesh, int faces, double* error = nullptr);

}  // namespace lodestone
