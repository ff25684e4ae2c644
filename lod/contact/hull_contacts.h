// Where a body's convex hull meets a plane: the exact support height, and the few vertices that carry the
// body.
#pragma once

#include <array>
#include <span>

#include "lod/ground/ground.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

struct HullContact {
  Vec3 arm = Vec3::Zero();   ///< m, from the centre of mass to the contact point, world axes
  double gap = 0.0;          ///< m, of the point over the plane; negative inside
  std::int32_t vertex = -1;  ///< of the hull; −1: of a sphere
};

/// The lowest point of a body over a plane with unit `normal`, its centre of mass at `height` over it. The
/// climb over the hull starts at `hint` and leaves the vertex that it found there.
inline HullContact find_lowest_point(const Shape& shape, const Quat& orientation, const Vec3& normal,
                                     double height, std::int32_t& hint) {
  if (shape.sphere_radius) return {-*shape.sphere_radius * normal, height - *shape.sphere_radius};
  hint = find_support(shape.hull, orientation.conjugate() * (-normal), hint);
  const Vec3 arm = orientation * shape.hull.vertices[hint];
  return {arm, height + arm.dot(normal), hint};
}

inline constexpr int kMaxGroundContacts = 4;

struct HullContacts {
  std::array<HullContact, kMaxGroundContacts + 1> contact;  ///< one more where the body may tip
  int count = 0;
};

/// How the gaps of a body's points change in a step, to first order.
struct GapChange {
  double of_center = 0.0;      ///< m, of the centre of mass
  Vec3 of_arm = Vec3::Zero();  ///< by its arm, body axes: a point's further change over its arm
  bool is_none() const { return of_center == 0.0 && of_arm.isZero(0.0); }
};

/// How a body turns in a step, world axes, if nothing but its lowest point bears it.
struct Tipping {
  Vec3 turn = Vec3::Zero();      ///< rad, without what its weight adds
  Mat3 by_lever = Mat3::Zero();  ///< rad/m: times that point's arm × the normal is what its weight adds
  bool is_none() const { return turn.isZero(0.0) && by_lever.isZero(0.0); }
};

/// The lowest point, and up to three more vertices with a gap below `margin`, now or after the `change`,
/// chosen to span the widest area of support; and of those below the margin the one onto which the body tips,
/// where that would get deeper than all of them: a round body has vertices between those that lie widest.
HullContacts find_hull_contacts(const Shape& shape, const Quat& orientation, const Vec3& normal,
                                double height, double margin, std::int32_t& hint,
                                const GapChange& change = {}, const Tipping& tipping = {});

/// The lowest vertex of a hull, whose number is `lowest`, and all others with a gap below `margin`, at most
/// as many as `found` holds: of more, those that lie outermost. Returns how many. `normal`: in body axes.
int find_vertices_below(const Shape& shape, const Vec3& normal, double height, double margin,
                        std::int32_t lowest, std::span<std::int32_t> found);

/// m: how far a body may be lifted out of the ground in `time` seconds; no bound unless it brought the
/// overlap from another rung.
double lift_of(const StatisticalBody& body, const Shape& shape, double gravity, double time);

/// Lifts a body that has sunk into `plane` out of it, by `farthest` m at most. Its fall becomes slower by
/// what its lowest point sinks further, or by the work of the lift under `gravity`, m/s²: what only turns
/// over an edge falls on.
void lift_out(StatisticalBody& body, const Shape& shape, const HalfSpace& plane, const Vec3& gravity,
              double farthest);

}  // namespace lodestone
