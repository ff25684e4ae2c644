// Turning a mesh's faces consistently outwards, piece by piece.
#pragma once

#include <string>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// Turns faces so that neighbours agree and each piece faces out of the solid: outwards, or inwards where the
/// piece lies inside another and so bounds a cavity. Fills in the report's edges, components and
/// faces_flipped. Throws InputError, with `name` at its head, for a one-sided surface (a Möbius band) or more
/// than 1,000 pieces.
void orient_faces(Mesh& mesh, const std::string& name, MeshReport& report);

}  // namespace lodestone
