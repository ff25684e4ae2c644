// What the solvers of contacts have in common: sequential impulses (Catto, Iterative dynamics with temporal
// coherence, 2005), projected Gauss–Seidel on velocities. They change the bodies' velocities so that no
// contact closes further than its gap within a step, with restitution and Coulomb friction. Each impulse acts
// on both bodies equally and oppositely, so momentum is exact to rounding. An overlap is kept from growing,
// not undone: that is a matter of positions (see push_out_overlap).
#pragma once

#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// Velocities that the solver changes. An inverse mass of zero cannot be moved.
struct SolverBody {
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
  double inverse_mass = 0.0;
  Mat3 inverse_inertia = Mat3::Zero();  ///< world axes
  bool in_great_heap = false;  ///< as StatisticalBody has it: asleep, read by crowds; else set by these
};

inline constexpr double kUnbounded = 1e300;

/// Ratio of masses that touch from which on sweeps alone do not carry a weight through the lighter body.
inline constexpr double kUnevenMasses = 12.0;

struct ContactSolverSettings {
  /// At most; fewer once no impulse changes by more than `tolerance` of the greatest, or in a crowd no
  /// velocity by more than that of `fall`.
  int sweeps = 10;
  double tolerance = 1e-4;
  /// Friction is bounded by μ times the normal impulses without friction, as dWorldStep with Approx1 has it;
  /// crowds choose that themselves.
  bool frictionless_bound = false;
  double bounce_velocity = 0.05;  ///< m/s, slower approaches do not bounce (as in ODE)
  /// Of one body on the ground: in a step contacts keep their places while it turns about them, as they do
  /// not where each moves along its tangent.
  bool along_chords = false;
  double sliding_speed = 0.0;  ///< m/s: but for those that go faster than so, and than friction can stop
  /// m/s, what gravity has given the velocities for this step: an impact on what stands still is answered as
  /// fast as it is when it happens, within the step.
  Vec3 fall = Vec3::Zero();
  /// m/s, of one body on the ground that a torque acts on: what its weight gives in the step; 0: none acts.
  double driven = 0.0;
  /// rad/s, of one body on the ground: what a torque has given it for this step, which is no impact.
  Vec3 turned = Vec3::Zero();
};

/// Of a point whose impulses along three axes are all relaxed from one velocity, though each moves it along
/// the others, too: from 1 on sweeps would swing ever wider, which friction bounds late or, a great one,
/// never, and each is to go half as far. `mass`: 1 over the response K along each axis; `coupled`: K from the
/// axes 0 to 1, 1 to 2, 2 to 0. (Sweeps never gain where 2 D − K, D being K's diagonal, is positive definite:
/// `swing` is 1 less its determinant over that of D. Where they go half as far it always is.) Numbers may be
/// lanes, which are not returned: how depends on the instruction set.
template <class Numbers>
[[gnu::always_inline]] inline void find_swing(const Numbers (&mass)[3], const Numbers (&coupled)[3],
                                              Numbers& swing) {
  const Numbers &a = coupled[0], &b = coupled[1], &c = coupled[2],
                all = (a * mass[0]) * (b * mass[1]) * (c * mass[2]);
  swing = (a * mass[0]) * (a * mass[1]) + (b * mass[1]) * (b * mass[2]) + (c * mass[2]) * (c * mass[0]) +
          (all + all);
}

/// m/s along the normal at the end of a `step` that a body began with `approach` (negative, with the step's
/// `fall` of gravity in it): it falls through the gap, bounces off what stands still and falls on.
double bounce_in_fall(double restitution, double gap, double approach, double fall, double step);

/// How far to move apart two bodies that overlap by −`gap`, m: a fraction a step, leaving a sliver so that
/// resting contacts persist. Moving positions rather than adding velocity keeps the correction out of the
/// kinetic energy.
inline double push_out_overlap(double gap, double radius) {
  return gap < -0.002 * radius ? 0.25 * (-gap - 0.002 * radius) : 0.0;
}

}  // namespace lodestone
