// A mesh of the ground, or of the caller's, that is a solid of few convex pieces: met as these it is met
// exactly, from whichever side a body comes. By its triangles alone a slab that a body sinks through within a
// substep holds it by its top and its bottom at once.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reference/ode/piece_contacts.h"

namespace lodestone::ode {

/// Null for an open mesh, one that is seen from within, a curved concave one, and one of more than 2,000
/// faces.
std::shared_ptr<const Shape> find_exact_solid(const std::string& name, Mesh mesh);

/// Its convex pieces in the frame of the mesh that it was made of.
std::vector<Piece> pieces_in_mesh(const Shape& solid);

}  // namespace lodestone::ode
