// Looking a signature's response up and drawing from it (3.3.2, steps 4 to 7).
#pragma once

#include <array>

#include "reference/random.h"
#include "signature/signature.h"

namespace lodestone {

/// Cells around a configuration and their weights, which sum to 1.
struct CellBlend {
  std::array<std::int32_t, 16> cell{};
  std::array<float, 16> weight{};
  int count = 0;
};

/// What was found for a configuration. `bouncing` and `slow` point into the signature.
struct FoundResponse {
  Response mean = Response::Zero(), deviation = Response::Zero();
  bool extrapolated = false;  ///< it lies outside of what was measured: the nearest was taken
  /// Of the restitution that V_particle has: less than 1 where slow approaches do not bounce.
  float bouncing_part = 1.0f;
  double least_bouncing_approach = 0.0;  ///< over s: ODE's bounce_vel
  const ResponseCells* bouncing = nullptr;
  /// Null where nothing is slower than bounce_vel, or the table knows by itself.
  const ResponseCells* slow = nullptr;
  CellBlend blend;
};

/// At `c`, linear between cells (nearest cell where `interpolate` is off). An angle outside of its range, a
/// speed beyond a speed table's or a NaN is clamped and flagged. `bounce_velocity`: ODE's, m/s.
FoundResponse find_response(const Signature& signature, const CollisionConfiguration& c,
                            double bounce_velocity, bool interpolate = true);

/// Velocities after a collision over s, in (e1, e2, e3); the angular one times R.
struct DrawnVelocities {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

/// One draw, as `draw` says as far as the signature holds what that needs (else independent). Where a
/// Gaussian would reach into the plane, the velocity out of it is lognormal, with the trials' mean and
/// deviation: cutting the Gaussian off would shift both. What still moves into the plane, a trial of the
/// empirical kind, loses that motion. `restitution` as the signature was measured for.
DrawnVelocities draw_response(const FoundResponse& found, const CollisionConfiguration& c, double restitution,
                              ResponseDraw draw, RandomStream& random);

}  // namespace lodestone
