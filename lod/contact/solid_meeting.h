// How a body meets one convex solid of the ground, or one triangle of a surface.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lod/contact/pair_contacts.h"
#include "lod/ground/ground.h"

namespace lodestone {

/// Of a solid, what a point is nearest to: which way, how far (negative: inside).
struct Nearest {
  Vec3 normal;           ///< in the part's axes
  double height = 0.0;   ///< m
  bool at_edge = false;  ///< of a solid's faces none is straight below: across an edge or a corner
  bool beyond = false;   ///< of a triangle, across an edge, beyond which its neighbour is nearer
};
/// `point` in the frame of the solid's shape. None behind the edge of a surface, where a neighbour is nearer.
std::optional<Nearest> find_nearest(const GroundSolid& solid, const Vec3& point);
/// Of a triangle, over the edges that do not stand out, too: above a corner of a saddle each of its triangles
/// has the point behind such an edge. None below it.
std::optional<Nearest> find_nearest_beyond(const GroundSolid& solid, const Vec3& point);

/// A face of a solid that a body passes along.
struct PassedFace {
  Vec3 normal;  ///< world
  double gap;   ///< m: how far the body is over the face's plane
  Vec3 lowest;  ///< of the body over it, world
  bool holds(const Vec3& along) const { return along.dot(normal) > 0.99; }  ///< a contact with that normal
};
/// That which the body is farthest over, by -`touching` m at least, now and once it has gone on by `way`, m.
/// No other face of the solid, and no edge, can be in its way: as little below the face of a flush neighbour
/// bodies would trip over the seam. None of a triangle of a surface.
std::optional<PassedFace> find_passed_face(const PairBody& body, const PlacedSolid& placed, const Vec3& way,
                                           double touching);

/// Appends the planes that stand for a solid to a hull: as a rule one, across the way to what its centre is
/// `nearest` to, or the face that it lies on though an edge is nearer. Where it hangs over an edge and below
/// the face beside that, those of their contacts, or none.
void find_planes_to_hull(const PairBody& body, const PlacedSolid& placed, const Nearest& nearest,
                         std::vector<Nearest>& found);

/// Over the inner radius: so deep below a triangle's surface what is over it meets it along its normal.
inline constexpr double kDeepestBelow = 0.25;

/// Which vertices of the hull a contact has: those that touch, or others that are near, too.
enum class MeetAhead : std::uint8_t { nothing, near };

/// Those contacts of the body with a gap of at most `margin` m: one of its hull, or, as find_pair_contacts
/// has it, those of its convex pieces. A triangle is met along its normal but for where an edge of it stands
/// out, by the hull. What `search` held before is gone. `ball_is_over`, m: how far below the centre of a ball
/// the nearest triangle is of those that this lies over: across an edge that does not stand out it meets none
/// that is farther.
void meet_solid(const PairBody& body, const PlacedSolid& placed, double margin, HullContactSearch& search,
                double ball_is_over = 1e300, MeetAhead ahead = MeetAhead::near);

/// Appends those contacts of the body, or of its convex pieces, that are along `normal` (unit, world).
void meet_along(const PairBody& body, const PlacedSolid& placed, const Vec3& normal, double margin,
                std::vector<PairContact>& found);

}  // namespace lodestone
