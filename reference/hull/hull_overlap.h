// How deep two hulls, or a hull and a plane, overlap, and which way out is the shortest. libccd's expanding
// polytope (van den Bergh, Proximity Queries and Penetration Depth Computation on 3D Game Objects, 2001) and
// its portal refinement (Snethen, XenoCollide, Game Programming Gems 7, 2008) on exact support functions come
// near the least overlap; from there a walk over the faces of the Minkowski difference ends on it.
#pragma once

#include <optional>

#include "reference/geometry.h"
#include "reference/shape.h"

namespace lodestone {

/// Moved along `direction` (unit, world) by `depth` (m), the first body is clear of the second.
struct HullOverlap {
  double depth = 0.0;
  Vec3 direction = Vec3::UnitZ();
};

/// The shortest translation that parts the convex hulls of two shapes; nothing where they are apart. A hull
/// wholly inside another overlaps. Exact to rounding for polyhedra (tested against every separating axis) and
/// for two spheres; to about 1e-3 × size between a sphere and another shape.
std::optional<HullOverlap> find_hull_overlap(const Shape& first, const RigidState& first_state,
                                             const Shape& second, const RigidState& second_state);

/// False where libccd's portal finds the hulls apart: asked first, it spares most pairs the rest.
bool may_hulls_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                       const RigidState& second_state);

/// Its depth (m); 0 where they are apart.
double measure_hull_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                            const RigidState& second_state);

/// The same, m, or where the hulls overlap by more than `allowed` and a shape has convex pieces
/// (Shape::pieces), of those: one L may hook into another.
double measure_pair_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                            const RigidState& second_state, double allowed = 0.0);

/// How deep the lowest point of a shape lies in the half-space normal·x ≤ offset (m); negative where it is
/// above.
double measure_plane_overlap(const Shape& shape, const RigidState& state, const Vec3& normal, double offset);

}  // namespace lodestone
