// Queries of the bodies and the ground where they are now: rays, swept spheres, spheres and boxes. All
// lengths are in m. A number that is not finite or out of its range throws InputError, and nothing is asked.
//
// - Bodies are met by their meshes (spheres as spheres), so that an answer does not depend on the rung.
// - Ground, also the caller's, is met by its planes and solids. A height field is met by rays; a swept sphere
//   meets the plane on it where the ray of its centre meets it, a volume the plane below its centre.
// - The caller's dynamic bodies are met by the solids of their geoms, round ones except spheres by polyhedra
//   of 32 sides. They are met where they are now, also if he moved or destroyed them since the last step. A
//   geom that he added or gave another shape since then is met as it is now only from the next step on.
// - The caller's ground is as the last step saw it. After he has destroyed a geom of it, he must make a step
//   before the next query.
// - If the caller has dynamic bodies, each call looks through his space once, however many rays or volumes it
//   has: it pays to put many into one call.
#pragma once

#include <limits>

#include "lod/events.h"

namespace lodestone {

/// What a query may meet.
struct QueryFilter {
  /// Only bodies whose category (BodyProperties::category; the geom's, of the caller's dynamic bodies) has
  /// one of these bits; ground is met whatever its bits.
  unsigned categories = ~0u;
  bool bodies = true, ground = true, callers = true;  ///< the manager's, ground, the caller's dynamic ones
  BodyId except = {};                                 ///< is not met: the body that asks; null: none
};

/// From `from` along `direction` (of any length but 0), `length` m (≥ 0, may be infinite). A ray meets
/// surfaces from outside only; it does not meet what it begins in.
struct Ray {
  Vec3 from = Vec3::Zero(), direction = -Vec3::UnitZ();
  double length = std::numeric_limits<double>::infinity();
};

/// A sphere whose centre moves along a ray. It meets what it overlaps at its start at a distance of 0.
struct SphereSweep {
  Ray ray;
  double radius = 0.5;  ///< > 0
};

/// A sphere at rest.
struct SphereVolume {
  Vec3 center = Vec3::Zero();
  double radius = 0.5;  ///< > 0
};

/// A box at rest.
struct BoxVolume {
  Vec3 sides = Vec3::Ones();            ///< whole edge lengths, > 0
  Vec3 position = Vec3::Zero();         ///< of its centre
  Quat orientation = Quat::Identity();  ///< of length 1 within 1e-3
};

/// What a query met.
struct QueryHit {
  ContactSide who;
  /// World: on the surface that is met. When a box overlaps anything but a plane: the position of what it
  /// overlaps, of ground that is met triangle by triangle a point of one of these.
  Vec3 point = Vec3::Zero();
  /// Unit, outward from that surface. When a box overlaps anything but a plane it is not known: z.
  Vec3 normal = Vec3::UnitZ();
  double distance = 0.0;  ///< that the ray or the sphere's centre has gone; 0 for an overlap
};

}  // namespace lodestone
