// The points in which two hulls touch across a common plane: the overlap of the two touching features
// (corner, edge or face), found by clipping one against the other (Sutherland and Hodgman, Reentrant polygon
// clipping, 1974), reduced to four points of wide support.
#pragma once

#include <array>

#include "lod/contact/hull_contacts.h"

namespace lodestone {

struct ManifoldPoint {
  Vec3 point = Vec3::Zero();  ///< half-way between the bodies, in the frame of the points given
  double gap = 0.0;           ///< m along the normal, negative where they overlap
};

struct Manifold {
  std::array<ManifoldPoint, 4> points;
  int count = 0;
};

/// `upper` and `lower`: the points of the upper body nearest to the lower one along `normal` (unit, from
/// lower to upper) and the other way round, as arms from a common origin; at most four each. No point has a
/// gap below `least_gap`. Empty where the features do not overlap.
Manifold find_manifold(const HullContacts& upper, const HullContacts& lower, const Vec3& normal,
                       double least_gap);

/// Of two patches of one contact, which may overlap: four points of the widest support.
Manifold join_manifolds(const Manifold& first, const Manifold& second, const Vec3& normal);

}  // namespace lodestone
