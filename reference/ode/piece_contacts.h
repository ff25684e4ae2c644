// Contacts of two bodies that are unions of convex pieces: those of every two pieces, exact to rounding, less
// those on faces within the body.
#pragma once

#include <vector>

#include "reference/contact_point.h"
#include "reference/shape.h"

namespace lodestone {

/// `shape` is convex, its centre of mass at `center` in the body's frame.
struct Piece {
  const Shape* shape;
  Vec3 center = Vec3::Zero();
};

/// A body in the world.
struct Pieces {
  std::vector<Piece> pieces;
  RigidState state;
  bool empty() const { return pieces.empty(); }
};

/// Appends the contacts, normals into `first`, depths less what bodies at rest are left to overlap (2e-5 ×
/// radius), so that their contacts stay.
void find_contacts_of_pieces(const Pieces& first, const Pieces& second, std::vector<ContactPoint>& contacts);

}  // namespace lodestone
