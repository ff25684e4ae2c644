// Where two hulls touch across a plane: the touching feature of each (corner, edge or face), and the points
// of their overlap (contact_manifold.h).
#pragma once

#include "lod/contact/pair_body.h"

namespace lodestone {

/// m: how much farther from the touching plane than its nearest vertex, beyond a hundredth of the lesser R,
/// others of a touching feature may be.
struct Ahead {
  double first = 0.0;  ///< of the first body
  double lying = 0.0;  ///< of a wide face that is about to lie
};

/// The overlap of the features with which the hulls touch across the axis of `best`, its points as arms from
/// the second body's position; empty where the features do not overlap.
Manifold clip_features(const PairBody& first, const PairBody& second, const HullGap& best,
                       const Ahead& ahead);

/// The same in world coordinates, with at least one point: where the features do not overlap, at the nearest
/// corner of the smaller one.
Manifold find_shared_points(const PairBody& first, const PairBody& second, const HullGap& best,
                            const Ahead& ahead);

}  // namespace lodestone
