// Collision heights: the radius of the paper's colliding sphere (3.2.1, 3.3.1, figure 3).
#pragma once

#include <vector>

namespace lodestone {

/// Collision heights by α, sampled evenly from α = 0 to π/2, so closely at small ‖ω‖/‖v‖ and sparsely at
/// large.
struct CollisionHeights {
  std::vector<float> mean;       ///< height of the centre of mass over the plane at contact, over R
  std::vector<float> deviation;  ///< standard deviation, over R; as many as `mean` has
};

/// A collision height's mean and standard deviation.
struct HeightStatistics {
  double mean = 0.0, deviation = 0.0;  ///< over R
};

/// The collision height at α = atan(R‖ω‖/‖v‖): linear between samples, or that of the nearest one without
/// `interpolate`.
HeightStatistics find_collision_height(const CollisionHeights& heights, double alpha,
                                       bool interpolate = true);

}  // namespace lodestone
