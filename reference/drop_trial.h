// Experiments with one body and ODE as the ground truth: drops to rest for comparison, single collisions and
// settles for signatures (the paper's sections 3.2.1–3.2.3).
#pragma once

#include <functional>

#include "reference/ode/ode_world.h"

namespace lodestone {

/// s: every method is observed at these instants, whatever its own step.
inline constexpr double kObservationStep = 1.0 / 60.0;
inline constexpr int kTruthSubsteps = 34;  ///< ODE's steps in one of those, of .49 ms: the ground truth
/// J/kg: a body whose kinetic energy over its mass stays below it is at rest, as comparisons see it.
inline constexpr double kRestEnergyPerMass = 2e-3;

/// Ranges of a drop's start for a body of .2–.4 m; other sizes scale lengths by λ and times by √λ (see
/// `drop_scale`).
struct DropConditions {
  double lowest_point_min = 0.3, lowest_point_max = 0.8;  ///< m above the plane
  double horizontal_speed = 1.0;                          ///< m/s, each of x and y uniform within ±
  double falling_speed = 1.0;                             ///< m/s, v_z uniform in [−, 0]
  double angular_speed = 10.0;                            ///< rad/s, |ω| uniform below, direction uniform
  double speed_scale = 1.0;                               ///< multiplies the three speeds
  double slope = 0.0;                                     ///< rad, tilt of the plane about y
};

/// λ: 1 for a body whose longest side is .2–.4 m, else that side over the nearer of the two.
double drop_scale(const Shape& shape);

/// The start of drop number `trial`: a function of (seed, trial) alone.
RigidState drop_state(const Shape& shape, const DropConditions& conditions, std::uint64_t seed,
                      std::uint32_t trial);

/// The plane that drops fall on: through the origin, tilted by the slope about y.
Vec3 drop_plane_normal(const DropConditions& conditions);

/// Called at t = 0, 1/60, 2/60 … s with the state; returning false ends the drop.
using DropObserverFunction = std::function<bool(double time, const RigidState& state)>;

/// One body falling on a plane under ODE, stepped by 1/60/`substeps` s, for `horizon` seconds.
void simulate_drop(OdeWorld& world, OdeBodyId body, double horizon, int substeps,
                   const DropObserverFunction& observe);

}  // namespace lodestone
