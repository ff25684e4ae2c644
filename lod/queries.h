// What a game asks of the bodies and the ground where they are now: rays, swept spheres, spheres and boxes.
//
// Bodies are met by their meshes on every rung (spheres as such), so that an answer does not change with a
// body's rung; ground, the caller's too, by its planes and solids, a height field by rays, and by what moves
// along them as by its plane where the ray meets it. The caller's dynamic bodies are met by the solids of
// their geoms, round ones but spheres by polyhedra of 32 sides: where they are now, though he moved or
// destroyed them since the last step; what he added or made another shape since is met as it is from the next
// step on. His ground is as the last step saw it: where he destroys a geom of it, questions wait for the next
// step. Where he has any, each call looks through his space once, however many questions it has: many belong
// in one call. All lengths in m.
#pragma once

#include <limits>

#include "lod/events.h"

namespace lodestone {

struct QueryFilter {
  /// Bodies are met whose category (BodyProperties; of the caller's: of the geom) has one of these bits.
  unsigned categories = ~0u;
  bool bodies = true, ground = true, callers = true;  ///< the manager's, ground, the caller's dynamic ones
  BodyId except = {};                                 ///< this body is not met: the one that asks
};

/// From `from` along `direction` (of any length but zero), `length` m (≥ 0, may be infinite). Surfaces are
/// met from outside: what a ray begins in it does not meet.
struct Ray {
  Vec3 from = Vec3::Zero(), direction = -Vec3::UnitZ();
  double length = std::numeric_limits<double>::infinity();
};

/// A sphere that moves along a ray. What it overlaps at its start it meets at once.
struct SphereSweep {
  Ray ray;
  double radius = 0.5;  ///< > 0
};

struct SphereVolume {
  Vec3 center = Vec3::Zero();
  double radius = 0.5;  ///< > 0
};

struct BoxVolume {
  Vec3 sides = Vec3::Ones();  ///< full ones, > 0
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

struct QueryHit {
  ContactSide who;
  /// World, on the surface that is met; of an overlap with a box: the body's position.
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< of that surface, outward; of an overlap with a box: none known, z
  double distance = 0.0;        ///< along the ray; 0 of an overlap
};

}  // namespace lodestone
