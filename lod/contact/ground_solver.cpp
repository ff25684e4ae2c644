#include "lod/contact/ground_solver.h"

#include <algorithm>
#include <cmath>

#include "lod/contact/contact_impulse.h"

namespace lodestone {
namespace {

Vec3 velocity_at(const GroundMotion& motion, const Vec3& arm) {
  return motion.velocity + motion.angular_velocity.cross(arm);
}

double velocity_along(const GroundMotion& motion, const GroundContact::Row& row) {
  return motion.velocity.dot(row.axis) + motion.angular_velocity.dot(row.lever);
}

void apply(GroundMotion& motion, const GroundContact::Row& row, double change) {
  motion.velocity += change * row.axis;
  motion.angular_velocity += change * row.turning;
}

void prepare(const GroundMotion& motion, const Mat3& inverse_inertia, GroundContact& c, double step,
             const ContactSolverSettings& settings) {
  const Vec3 velocity = velocity_at(motion, c.arm);
  const Mat3 frame = contact_frame(c.normal, velocity);
  for (int i = 0; i < 3; ++i) {
    GroundContact::Row& row = c.rows[std::size_t(i)];
    row.axis = frame.col(i);
    row.lever = c.arm.cross(row.axis);
    row.turning = inverse_inertia * row.lever;
    row.effective_mass = 1.0 / (1.0 + row.lever.dot(row.turning));
    row.impulse = 0.0;
  }
  const double approach = velocity.dot(c.normal), closing = std::min(0.0, -c.gap / step),
               fall = std::min(0.0, settings.fall.dot(c.normal));
  c.bounces = approach < -settings.bounce_velocity && c.gap + approach * step < 0.0;
  c.target =
      c.bounces ? std::max(bounce_in_fall(c.law.restitution, c.gap, approach, fall, step), closing) : closing;
}

double friction_bound(const GroundContact& c) {
  return c.friction_bound >= 0.0 ? c.friction_bound : c.law.friction * c.rows[0].impulse;
}

// Returns the size of the change, N s over mass.
double relax(GroundMotion& motion, GroundContact& c) {
  const double closing = velocity_along(motion, c.rows[0]),
               slip[2] = {velocity_along(motion, c.rows[1]), velocity_along(motion, c.rows[2])};
  const auto change_to = [&](GroundContact::Row& row, double impulse) {
    const double change = impulse - row.impulse;
    row.impulse = impulse;
    apply(motion, row, change);
    return std::abs(change);
  };
  GroundContact::Row& normal = c.rows[0];
  double changed =
      change_to(normal, std::max(0.0, normal.impulse + normal.effective_mass * (c.target - closing)));
  const double bound = friction_bound(c);
  for (std::size_t t = 0; t < 2; ++t) {
    GroundContact::Row& row = c.rows[t + 1];
    changed += change_to(row, std::clamp(row.impulse - row.effective_mass * slip[t], -bound, bound));
  }
  return changed;
}

void start_from_guess(GroundMotion& motion, GroundContact& c) {
  if (c.bounces || c.guess.isZero(0.0)) return;
  c.rows[0].impulse = std::max(0.0, c.guess.dot(c.normal));
  const double bound = friction_bound(c);
  for (std::size_t t = 1; t < 3; ++t)
    c.rows[t].impulse = std::clamp(c.guess.dot(c.rows[t].axis), -bound, bound);
  for (const GroundContact::Row& row : c.rows) apply(motion, row, row.impulse);
}

void sweep(GroundMotion& motion, std::span<GroundContact> contacts, const ContactSolverSettings& settings) {
  for (int i = 0; i < settings.sweeps; ++i) {
    double changed = 0.0, greatest = 0.0;
    for (GroundContact& c : contacts) {
      changed = std::max(changed, relax(motion, c));
      greatest = std::max(greatest, c.rows[0].impulse);
    }
    if (changed <= settings.tolerance * greatest) return;
  }
}

// What the normal impulses are without friction bounds it.
void bound_friction(GroundMotion motion, std::span<GroundContact> contacts,
                    const ContactSolverSettings& settings) {
  for (GroundContact& c : contacts) c.friction_bound = 0.0;
  for (GroundContact& c : contacts) start_from_guess(motion, c);
  sweep(motion, contacts, settings);
  for (GroundContact& c : contacts) {
    c.friction_bound = c.law.friction * c.rows[0].impulse;
    c.rows[0].impulse = 0.0;
  }
}

}  // namespace

void solve_ground_contacts(GroundMotion& motion, const Mat3& inverse_inertia,
                           std::span<GroundContact> contacts, double step,
                           const ContactSolverSettings& settings) {
  for (GroundContact& c : contacts) prepare(motion, inverse_inertia, c, step, settings);
  if (settings.frictionless_bound) bound_friction(motion, contacts, settings);
  for (GroundContact& c : contacts) start_from_guess(motion, c);
  sweep(motion, contacts, settings);
}

}  // namespace lodestone
