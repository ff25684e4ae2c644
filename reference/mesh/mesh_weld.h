// Joining vertices that lie in the same place: files often give each face its own copies.
#pragma once

#include "reference/mesh/mesh.h"

namespace lodestone {

/// Makes faces use the first of all vertices within `distance_m` of each other. Returns how many vertices are
/// no longer used.
int weld_vertices(Mesh& mesh, double distance_m);

}  // namespace lodestone
