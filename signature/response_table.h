// Looking a signature's tables up (3.3.1, 3.3.2 steps 4–5).
#pragma once

#include "signature/signature.h"

namespace lodestone {

/// The mean and deviation found for a configuration, and whether it lay outside the cells that were measured.
struct ResponseStatistics {
  Response mean = Response::Zero(), deviation = Response::Zero();
  bool extrapolated = false;
};

/// At (θ, φ, α) in radians, trilinear between cell centres (nearest cell where `interpolate` is off). θ beyond π/2 or a NaN is clamped and flagged.
ResponseStatistics find_response(const ResponseTable& table, double theta, double phi, double alpha, bool interpolate = true);

struct HeightStatistics {
  double mean = 0.0, deviation = 0.0;  ///< over R
};

/// Collision height at α = atan(R‖ω‖/‖v‖), linear between samples (nearest where `interpolate` is off).
HeightStatistics find_collision_height(const CollisionHeights& heights, double alpha, bool interpolate = true);

/// The centre of cell `i` of `n` over [0, range].
inline double cell_center(int i, int n, double range) { return (i + 0.5) * range / n; }

}  // namespace lodestone
