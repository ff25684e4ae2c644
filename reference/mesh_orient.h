// The edges of a mesh, the pieces that they join, and turning each piece's faces consistently outwards.
#pragma once

#include <string>
#include <vector>

#include "reference/mesh.h"

namespace lodestone {

/// One face's use of the edge between vertices `low` < `high`.
struct EdgeUse {
  int low = 0, high = 0, face = 0;
  bool forward = false;  ///< the face runs from low to high
};

/// All uses, those of one edge side by side.
std::vector<EdgeUse> find_edge_uses(const Mesh& mesh);

/// Turns faces so that neighbours agree and each piece faces out of the solid: outwards, or inwards where the piece
/// lies inside another and so bounds a cavity. Fills in the report's edges, components and faces_flipped.
/// Throws InputError, with `name` at its head, for a one-sided surface (a Möbius band) or more than 1,000 pieces.
void orient_faces(Mesh& mesh, const std::string& name, MeshReport& report);

}  // namespace lodestone
