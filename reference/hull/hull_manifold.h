// The contact points of two hulls that overlap: where the one's surface lies inside the other, seen along the
// shortest way out. Those of greatest depth are corners of a hull within the other and crossings of two
// edges, so these are all that is looked for.
#pragma once

#include <vector>

#include "reference/contact_point.h"
#include "reference/hull/hull_overlap.h"

namespace lodestone {

/// Appends the contacts of the convex hulls of two shapes that overlap by `overlap`: normals all along its
/// direction, each depth (m) the way that the first goes along it until the two are clear of each other at
/// that place, the greatest `overlap.depth`. Points lie halfway between the surfaces.
void find_hull_manifold(const Shape& first, const RigidState& first_state, const Shape& second,
                        const RigidState& second_state, const HullOverlap& overlap,
                        std::vector<ContactPoint>& contacts);

}  // namespace lodestone
