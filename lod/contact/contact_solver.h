// Many contacts at once: sequential impulses (Catto, Iterative dynamics with temporal coherence, 2005),
// projected Gauss–Seidel on velocities. Each impulse acts on both bodies equally and oppositely, so momentum
// is exact to rounding.
#pragma once

#include <cstdint>
#include <span>

#include "lod/simd/wide_loop.h"
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

struct SolverContact {
  std::int32_t first = 0, second = -1;  ///< indices of SolverBody; second −1: the ground
  Vec3 normal = Vec3::UnitZ();          ///< points into `first`
  Vec3 arm_first = Vec3::Zero(), arm_second = Vec3::Zero();  ///< from each centre of mass to the shared point
  double gap = 0.0;                                          ///< m, negative where they overlap
  ContactLaw law;
  Vec3 guess = Vec3::Zero();   ///< N s, on `first`: what a resting contact starts from
  double frictionless = -1.0;  ///< N s, normal impulse to start from where there is no friction; below zero:
                               ///< that of `guess`. What it comes to, where friction is bounded by it
  double most_impulse = kUnbounded;  ///< N s, along the normal; a bounded one is a motor's, which closes or
                                     ///< opens the gap, however wide, just within the step
  // Filled by the solver:
  Vec3 tangent[2] = {Vec3::Zero(), Vec3::Zero()};
  double target = 0.0;            ///< m/s, normal velocity asked for
  bool bounces = false;           ///< an impact, fast enough for restitution
  double impact_time = 0.0;       ///< s, of one that bounces: when in the step its gap is closed
  double impulse[3] = {0, 0, 0};  ///< N s, along the normal and both tangents
};

/// N s, on the first body.
inline Vec3 impulse_of(const SolverContact& c) {
  return c.impulse[0] * c.normal + c.impulse[1] * c.tangent[0] + c.impulse[2] * c.tangent[1];
}

struct ContactSolverSettings {
  int sweeps = 10;  ///< at most; fewer once no impulse changes by more than `tolerance` of the greatest
  double tolerance = 1e-4;
  bool frictionless_bound = false;  ///< friction is bounded by μ times the normal impulses without friction,
                                    ///< as dWorldStep with Approx1 has it
  double bounce_velocity = 0.05;    ///< m/s, slower approaches do not bounce (as in ODE)
  Vec3 fall = Vec3::Zero();  ///< m/s, what gravity has given the velocities for this step: an impact on what
                             ///< stands still is answered as fast as it is when it happens, within the step
};

/// Changes the bodies' velocities so that no contact closes further than its gap within `step` seconds, with
/// restitution and Coulomb friction. An overlap is kept from growing, not undone: that is a matter of
/// positions (see push_out_overlap).
void solve_contacts(std::span<SolverBody> bodies, std::span<SolverContact> contacts, double step,
                    const ContactSolverSettings& settings, Simd simd = find_simd());

/// Of contacts: a run in a row.
struct IslandRun {
  std::uint32_t begin = 0, count = 0;
  int sweeps = 10;  ///< at most
};

/// The same of several runs at a time that share no body: each has the result that it has alone. `sweeps` are
/// those of the runs.
void solve_contacts(std::span<SolverBody> bodies, std::span<SolverContact> contacts,
                    std::span<const IslandRun> runs, double step, const ContactSolverSettings& settings,
                    Simd simd = find_simd());

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
