#include "lod/contact/contact_solver.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lod/contact/contact_impulse.h"
#include "lod/simd/wide_loop.h"

namespace lodestone {
namespace {

// What stands on the ground (second below zero) meets nothing that moves.
LODESTONE_INLINE Vec3 contact_velocity(std::span<const SolverBody> bodies, const SolverContact& c) {
  const SolverBody& a = bodies[c.first];
  const Vec3 of_first = a.velocity + a.angular_velocity.cross(c.arm_first);
  if (c.second < 0) return of_first;
  const SolverBody& b = bodies[c.second];
  return of_first - b.velocity - b.angular_velocity.cross(c.arm_second);
}

LODESTONE_INLINE double inverse_mass_along(const SolverBody& body, const Vec3& arm, const Vec3& axis) {
  const Vec3 turning = arm.cross(axis);
  return body.inverse_mass + turning.dot(body.inverse_inertia * turning);
}

LODESTONE_INLINE double effective_mass_along(std::span<const SolverBody> bodies, const SolverContact& c,
                                             const Vec3& axis) {
  double inverse = inverse_mass_along(bodies[c.first], c.arm_first, axis);
  if (c.second >= 0) inverse += inverse_mass_along(bodies[c.second], c.arm_second, axis);
  return 1.0 / inverse;
}

LODESTONE_INLINE void apply(std::span<SolverBody> bodies, const SolverContact& c, const Vec3& impulse) {
  SolverBody& a = bodies[c.first];
  a.velocity += a.inverse_mass * impulse;
  a.angular_velocity += a.inverse_inertia * c.arm_first.cross(impulse);
  if (c.second < 0) return;
  SolverBody& b = bodies[c.second];
  b.velocity -= b.inverse_mass * impulse;
  b.angular_velocity -= b.inverse_inertia * c.arm_second.cross(impulse);
}

// The normal velocity to reach: a bounce, or closing the gap just within the step.
double target_velocity(SolverContact& c, bool on_still, double approach, double step,
                       const ContactSolverSettings& s) {
  const double closing = std::min(0.0, -c.gap / step),
               fall = on_still ? std::min(0.0, s.fall.dot(c.normal)) : 0.0;
  c.bounces = approach < -s.bounce_velocity && c.gap + approach * step < 0.0;
  if (c.bounces) c.impact_time = std::max(0.0, c.gap) / -approach;
  return c.bounces ? std::max(bounce_in_fall(c.law.restitution, c.gap, approach, fall, step), closing)
                   : closing;
}

void prepare(std::span<SolverBody> bodies, SolverContact& c, double step, const ContactSolverSettings& s) {
  const Vec3 velocity = contact_velocity(bodies, c);
  const Mat3 frame = contact_frame(c.normal, velocity);
  c.tangent[0] = frame.col(1);
  c.tangent[1] = frame.col(2);
  for (int i = 0; i < 3; ++i) c.effective_mass[i] = effective_mass_along(bodies, c, frame.col(i));
  const bool on_still = c.second < 0 || bodies[c.second].inverse_mass == 0.0;
  c.target = target_velocity(c, on_still, velocity.dot(c.normal), step, s);
}

// Returns the size of the change, N s.
LODESTONE_INLINE double relax(std::span<SolverBody> bodies, SolverContact& c) {
  const Vec3 velocity = contact_velocity(bodies, c);
  const double before = c.impulse[0];
  c.impulse[0] = std::max(0.0, before + c.effective_mass[0] * (c.target - velocity.dot(c.normal)));
  Vec3 change = (c.impulse[0] - before) * c.normal;
  const double bound = c.friction_bound >= 0.0 ? c.friction_bound : c.law.friction * c.impulse[0];
  for (int t = 0; t < 2; ++t) {
    const double held = c.impulse[t + 1];
    c.impulse[t + 1] = std::clamp(held - c.effective_mass[t + 1] * velocity.dot(c.tangent[t]), -bound, bound);
    change += (c.impulse[t + 1] - held) * c.tangent[t];
  }
  apply(bodies, c, change);
  return change.lpNorm<1>();
}

void start_from_guess(std::span<SolverBody> bodies, SolverContact& c) {
  if (c.bounces || c.guess.isZero(0.0)) return;
  c.impulse[0] = std::max(0.0, c.guess.dot(c.normal));
  const double bound = c.friction_bound >= 0.0 ? c.friction_bound : c.law.friction * c.impulse[0];
  for (int t = 0; t < 2; ++t) c.impulse[t + 1] = std::clamp(c.guess.dot(c.tangent[t]), -bound, bound);
  apply(bodies, c, impulse_of(c));
}

void sweep(std::span<SolverBody> bodies, std::span<SolverContact> contacts,
           const ContactSolverSettings& settings) {
  for (int i = 0; i < settings.sweeps; ++i) {
    double changed = 0.0, greatest = 0.0;
    for (SolverContact& c : contacts) {
      changed = std::max(changed, relax(bodies, c));
      greatest = std::max(greatest, c.impulse[0]);
    }
    if (changed <= settings.tolerance * greatest) return;
  }
}

// What the normal impulses are without friction bounds it.
void bound_friction(std::span<SolverBody> bodies, std::span<SolverContact> contacts,
                    const ContactSolverSettings& settings) {
  thread_local std::vector<SolverBody> before;
  before.assign(bodies.begin(), bodies.end());
  for (SolverContact& c : contacts) c.friction_bound = 0.0;
  for (SolverContact& c : contacts) start_from_guess(bodies, c);
  sweep(bodies, contacts, settings);
  std::ranges::copy(before, bodies.begin());
  for (SolverContact& c : contacts) {
    c.friction_bound = c.law.friction * c.impulse[0];
    c.impulse[0] = 0.0;
  }
}

}  // namespace

// With v₀ the velocity before the step's gravity a, the gap h is closed at vᵢ = −√(v₀² − 2 a h), after
// t = −2 h/(v₀ + vᵢ) (v is linear in time, so h is the mean velocity times t); then −e vᵢ, and a for what is
// left.
double bounce_in_fall(double restitution, double gap, double approach, double fall, double step) {
  const double before = approach - fall, acceleration = fall / step, way = std::max(0.0, gap);
  const double impact = -std::sqrt(std::max(0.0, before * before - 2.0 * acceleration * way));
  const double time = before + impact < 0.0 ? std::clamp(-2.0 * way / (before + impact), 0.0, step) : 0.0;
  return -restitution * impact + acceleration * (step - time);
}

void solve_contacts(std::span<SolverBody> bodies, std::span<SolverContact> contacts, double step,
                    const ContactSolverSettings& settings) {
  for (SolverContact& c : contacts) prepare(bodies, c, step, settings);
  if (settings.frictionless_bound) bound_friction(bodies, contacts, settings);
  for (SolverContact& c : contacts) start_from_guess(bodies, c);
  sweep(bodies, contacts, settings);
}

}  // namespace lodestone
