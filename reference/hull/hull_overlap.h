// How deep two hulls, or a hull and a plane, overlap: libccd's Minkowski portal refinement (Snethen, XenoCollide, Game Programming
// Gems 7, 2008) on exact support functions. A hull wholly inside another counts as overlapping.
#pragma once

#include "reference/geometry.h"
#include "reference/shape.h"

namespace lodestone {

/// The length of a translation that parts the convex hulls of two shapes (m); 0 where they are apart. Close to the shortest one where the
/// overlap is shallow, above it where it is deep.
double measure_hull_overlap(const Shape& first, const RigidState& first_state, const Shape& second, const RigidState& second_state);

/// How deep the lowest point of a shape lies in the half-space normal·x ≤ offset (m); negative where it is above.
double measure_plane_overlap(const Shape& shape, const RigidState& state, const Vec3& normal, double offset);

}  // namespace lodestone
