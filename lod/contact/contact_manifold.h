// The points in which two hulls touch across a common plane: the overlap of the two touching features
// (corner, edge or face), found by clipping one against the other (Sutherland and Hodgman, Reentrant polygon
// clipping, 1974), reduced to four points of wide support.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "reference/geometry.h"
#include "reference/state_archive.h"

namespace lodestone {

struct ManifoldPoint {
  Vec3 point = Vec3::Zero();  ///< half-way between the bodies, in the frame of the points given
  double gap = 0.0;           ///< m along the normal, negative where they overlap
};

struct Manifold {
  std::array<ManifoldPoint, 4> points;
  int count = 0;

  void archive(StateArchive& a) {
    a(count);
    for (std::size_t i = 0; i < std::min(std::size_t(count), points.size()); ++i) a(points[i]);
  }
};

/// Of a touching feature, at most: a face of more corners loses little where it is one of so many.
inline constexpr int kMostCorners = 64;

/// `upper` and `lower`: the points of the upper body nearest to the lower one along `normal` (unit, from
/// lower to upper) and the other way round, as arms from a common origin; at most kMostCorners each, in any
/// order. No point has a gap below `least_gap`. Empty where the features do not overlap.
Manifold find_manifold(std::span<const Vec3> upper, std::span<const Vec3> lower, const Vec3& normal,
                       double least_gap);

/// Of two patches of one contact, which may overlap: four points of the widest support.
Manifold join_manifolds(const Manifold& first, const Manifold& second, const Vec3& normal);

}  // namespace lodestone
