// How a body meets one convex solid of the ground, or one triangle of a surface.
#pragma once

#include <optional>

#include "lod/contact/pair_contacts.h"
#include "lod/ground/ground.h"

namespace lodestone {

/// Of a solid, what a point is nearest to: which way, how far (negative: inside).
struct Nearest {
  Vec3 normal;           ///< in the part's axes
  double height = 0.0;   ///< m
  bool at_edge = false;  ///< of a solid's faces none is straight below: across an edge or a corner
};
/// `point` in the frame of the solid's shape. None behind the edge of a surface, where a neighbour is nearer.
std::optional<Nearest> find_nearest(const GroundSolid& solid, const Vec3& point);

/// What keeps a body farthest from a solid, of `nearest`, which is of its centre, and the solid's faces that
/// the centre lies over: what overhangs an edge lies on the face, though the edge is nearer.
Nearest find_farthest_apart(const PairBody& body, const PlacedSolid& placed, const Nearest& nearest);

/// Those contacts of the body with a gap of at most `margin` m: one of its hull, or, as find_pair_contacts
/// has it, those of its convex pieces. A triangle is met along its normal but for where an edge of it stands
/// out, by the hull. What `search` held before is gone.
void meet_solid(const PairBody& body, const PlacedSolid& placed, double margin, HullContactSearch& search);

}  // namespace lodestone
