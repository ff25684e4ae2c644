// The paper's radius of the colliding sphere (3.2.1, 3.3.1, figure 3).
#pragma once

#include <vector>

namespace lodestone {

/// Collision height over α: sampled evenly in α from 0 to π/2, so closely at small ‖ω‖/‖v‖ and sparsely at
/// large.
struct CollisionHeights {
  std::vector<float> mean;  ///< height of the centre of mass over the plane at contact, over R
  std::vector<float> deviation;
};

struct HeightStatistics {
  double mean = 0.0, deviation = 0.0;  ///< over R
};

/// At α = atan(R‖ω‖/‖v‖), linear between samples (nearest where `interpolate` is off).
HeightStatistics find_collision_height(const CollisionHeights& heights, double alpha,
                                       bool interpolate = true);

}  // namespace lodestone
