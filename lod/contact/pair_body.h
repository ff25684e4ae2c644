// Two bodies, or two of their convex pieces, as their contacts are found, and such a contact.
#pragma once

#include "lod/contact/contact_manifold.h"
#include "lod/contact/hull_gap.h"
#include "reference/shape.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A body as pair contacts see it, of either level.
struct PairBody {
  const Shape* shape = nullptr;
  Vec3 position = Vec3::Zero();  ///< m, of the centre of mass
  Quat orientation = Quat::Identity();
};

inline PlacedHull placed_hull(const PairBody& body) { return {*body.shape, body.position, body.orientation}; }

/// One of its convex pieces; the body itself where it has none.
inline PairBody piece_of(const PairBody& body, int piece) {
  if (body.shape->pieces.empty()) return body;
  PairBody part = body;
  part.shape = &body.shape->pieces[std::size_t(piece)];
  part.position += body.orientation * part.shape->center_of_mass_in_mesh;
  return part;
}

struct PairContact {
  Vec3 normal = Vec3::UnitZ();  ///< from the second body into the first
  double gap = 0.0;             ///< m, the least; negative where they overlap
  Manifold manifold;            ///< one to four points that both bodies share, world

  void archive(StateArchive& a) { a(normal, gap, manifold); }
};

}  // namespace lodestone
