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

/// The contacts of one solution, and what they begin with.
class GroundSolver {
 public:
  GroundSolver(GroundMotion& motion, const Mat3& inverse_inertia, std::span<GroundContact> contacts,
               double step, const ContactSolverSettings& settings)
      : motion_(motion),
        before_(motion),
        inverse_inertia_(inverse_inertia),
        contacts_(contacts),
        settings_(settings) {
    for (GroundContact& c : contacts_) prepare(c, step);
  }
  void solve() {
    if (settings_.frictionless_bound) bound_friction();
    for (GroundContact& c : contacts_) start_from_guess(c);
    sweep();
  }

 private:
  void set_row(GroundContact::Row& row, const Vec3& axis, const Vec3& arm) const {
    row.axis = axis;
    row.lever = arm.cross(axis);
    row.turning = inverse_inertia_ * row.lever;
    row.effective_mass = 1.0 / (1.0 + row.lever.dot(row.turning));
    row.impulse = 0.0;
  }
  void prepare(GroundContact& c, double step) const;
  void find_tangents(GroundContact& c) const;
  double relax(GroundContact& c);
  void start_from_guess(GroundContact& c);
  void sweep();
  void bound_friction();

  GroundMotion& motion_;
  GroundMotion before_;
  const Mat3& inverse_inertia_;
  std::span<GroundContact> contacts_;
  const ContactSolverSettings& settings_;
};

void GroundSolver::prepare(GroundContact& c, double step) const {
  set_row(c.rows[0], c.normal, c.arm);
  c.rows[1] = c.rows[2] = {};
  const double approach = velocity_at(before_, c.arm).dot(c.normal), closing = std::min(0.0, -c.gap / step),
               fall = std::min(0.0, settings_.fall.dot(c.normal));
  c.bounces = approach < -settings_.bounce_velocity && c.gap + approach * step < 0.0;
  c.target =
      c.bounces ? std::max(bounce_in_fall(c.law.restitution, c.gap, approach, fall, step), closing) : closing;
}

// Once it carries something: most of the points that may touch never do.
void GroundSolver::find_tangents(GroundContact& c) const {
  if (c.rows[1].effective_mass > 0.0) return;
  const Mat3 frame = contact_frame(c.normal, velocity_at(before_, c.arm));
  for (int i = 1; i < 3; ++i) set_row(c.rows[std::size_t(i)], frame.col(i), c.arm);
}

double friction_bound(const GroundContact& c) {
  return c.friction_bound >= 0.0 ? c.friction_bound : c.law.friction * c.rows[0].impulse;
}

// Returns the size of the change, N s over mass.
double GroundSolver::relax(GroundContact& c) {
  const GroundMotion now = motion_;
  const auto change_to = [&](GroundContact::Row& row, double impulse) {
    const double change = impulse - row.impulse;
    row.impulse = impulse;
    apply(motion_, row, change);
    return std::abs(change);
  };
  GroundContact::Row& normal = c.rows[0];
  const double closing = velocity_along(now, normal),
               impulse = std::max(0.0, normal.impulse + normal.effective_mass * (c.target - closing));
  double changed = impulse == normal.impulse ? 0.0 : change_to(normal, impulse);
  const double bound = friction_bound(c);
  if (bound == 0.0 && c.rows[1].impulse == 0.0 && c.rows[2].impulse == 0.0) return changed;
  find_tangents(c);
  const double slip[2] = {velocity_along(now, c.rows[1]), velocity_along(now, c.rows[2])};
  for (std::size_t t = 0; t < 2; ++t) {
    GroundContact::Row& row = c.rows[t + 1];
    changed += change_to(row, std::clamp(row.impulse - row.effective_mass * slip[t], -bound, bound));
  }
  return changed;
}

void GroundSolver::start_from_guess(GroundContact& c) {
  if (c.bounces || c.guess.isZero(0.0)) return;
  c.rows[0].impulse = std::max(0.0, c.guess.dot(c.normal));
  const double bound = friction_bound(c);
  if (bound > 0.0) find_tangents(c);
  for (std::size_t t = 1; t < 3; ++t)
    c.rows[t].impulse = std::clamp(c.guess.dot(c.rows[t].axis), -bound, bound);
  for (const GroundContact::Row& row : c.rows) apply(motion_, row, row.impulse);
}

void GroundSolver::sweep() {
  for (int i = 0; i < settings_.sweeps; ++i) {
    double changed = 0.0, greatest = 0.0;
    for (GroundContact& c : contacts_) {
      changed = std::max(changed, relax(c));
      greatest = std::max(greatest, c.rows[0].impulse);
    }
    if (changed <= settings_.tolerance * greatest) return;
  }
}

// What the normal impulses are without friction bounds it.
void GroundSolver::bound_friction() {
  for (GroundContact& c : contacts_) c.friction_bound = 0.0;
  for (GroundContact& c : contacts_) start_from_guess(c);
  sweep();
  for (GroundContact& c : contacts_) {
    c.friction_bound = c.law.friction * c.rows[0].impulse;
    c.rows[0].impulse = 0.0;
  }
  motion_ = before_;
}

}  // namespace

void solve_ground_contacts(GroundMotion& motion, const Mat3& inverse_inertia,
                           std::span<GroundContact> contacts, double step,
                           const ContactSolverSettings& settings) {
  GroundSolver(motion, inverse_inertia, contacts, step, settings).solve();
}

}  // namespace lodestone
