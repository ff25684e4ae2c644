// Parts of a mesh that lie in each other: what a repair leaves as it is, and a user should know.
#pragma once

#include "reference/mesh/mesh.h"

namespace lodestone {

struct MeshParts {
  int parts = 0;        ///< pieces connected through shared vertices
  int nested = 0;       ///< that lie in another one wholly: cavities, or what counts twice
  int overlapping = 0;  ///< that lie in another one partly: what is common counts twice in volume and mass
};

/// By the corners of the parts, at most kPartCorners of each, evenly chosen: a part that reaches into another
/// with an edge or a small corner alone may be missed.
inline constexpr int kPartCorners = 200;
MeshParts find_mesh_parts(const Mesh& mesh);

}  // namespace lodestone
