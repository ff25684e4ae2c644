// The edges of a mesh and the faces that meet there.
#pragma once

#include <functional>
#include <span>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// One face's use of the edge between vertices `low` < `high`.
struct EdgeUse {
  int low = 0, high = 0, face = 0;
  bool forward = false;  ///< the face runs from low to high
};

/// Calls `visit` once for each edge, in order of its vertices, with all its uses: two where the surface is
/// closed and simple.
void visit_edges(const Mesh& mesh, const std::function<void(std::span<const EdgeUse>)>& visit);

}  // namespace lodestone
