// Taking out of a mesh what bounds nothing. Each function returns how many it dropped.
#pragma once

#include "reference/mesh/mesh.h"

namespace lodestone {

/// Faces that name a vertex twice.
int drop_degenerate_faces(Mesh& mesh);

/// Of faces on the same corners all but the first, or both where two back to back (a fin, an inner wall) are
/// better gone.
int drop_duplicate_faces(Mesh& mesh);

/// Faces whose corners lie in a line to within `distance_m`, unless that would tear the surface open: such
/// slivers may fill a seam.
int drop_flat_faces(Mesh& mesh, double distance_m);

/// Vertices of no face.
int drop_unused_vertices(Mesh& mesh);

}  // namespace lodestone
