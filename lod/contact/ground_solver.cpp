#include "lod/contact/ground_solver.h"

#include <algorithm>
#include <cmath>

#include "lod/contact/contact_impulse.h"
#include "reference/friction_across.h"

namespace lodestone {
namespace {

// A motion as the sweeps hold it, two numbers side by side: of v and ω, x and y of v, its z and x of ω, y and
// z of ω.
class PairedMotion {
 public:
  explicit PairedMotion(const GroundMotion& m)
      : first_{m.velocity[0], m.velocity[1]},
        middle_{m.velocity[2], m.angular_velocity[0]},
        last_{m.angular_velocity[1], m.angular_velocity[2]} {}
  GroundMotion motion() const {
    return {Vec3(first_[0], first_[1], middle_[0]), Vec3(middle_[1], last_[0], last_[1])};
  }
  /// velocity·axis + ω·lever, each summed from its first part on.
  double along(const GroundContact::Row& row) const {
    const Pair v = first_ * Pair{row.axis[0], row.axis[1]},
               of_both = middle_ * Pair{row.axis[2], row.lever[0]},
               w = last_ * Pair{row.lever[1], row.lever[2]};
    const Pair sum = Pair{v[0], of_both[1]} + Pair{v[1], w[0]} + Pair{of_both[0], w[1]};
    return sum[0] + sum[1];
  }
  void apply(const GroundContact::Row& row, double change) {
    const Pair both{change, change};
    first_ += both * Pair{row.axis[0], row.axis[1]};
    middle_ += both * Pair{row.axis[2], row.turning[0]};
    last_ += both * Pair{row.turning[1], row.turning[2]};
  }

 private:
  using Pair = double __attribute__((vector_size(16)));
  Pair first_, middle_, last_;
};

constexpr double kMostTurn = 1.0;  // rad in a step, for contacts that keep their places

/// The contacts of one solution, and what they begin with.
class GroundSolver {
 public:
  GroundSolver(GroundMotion& motion, const Mat3& inverse_inertia, std::span<GroundContact> contacts,
               double step, const ContactSolverSettings& settings)
      : motion_(motion),
        before_(motion),
        inverse_inertia_(inverse_inertia),
        contacts_(contacts),
        step_(step),
        settings_(settings),
        along_chords_(settings.along_chords &&
                      step * step * motion.angular_velocity.squaredNorm() < kMostTurn * kMostTurn) {
    for (GroundContact& c : contacts_) prepare(c);
  }
  void solve() {
    if (settings_.frictionless_bound) bound_friction();
    for (GroundContact& c : contacts_) start_from_guess(c);
    sweep();
  }

 private:
  /// m/s along `axis`, of the point at `arm`: −½ h ω × (ω × r), with which it stays in its place while the
  /// body turns about it. A velocity at right angles to the arm alone would carry the body along the tangent
  /// of its arc, and the next step take from it what of its velocity is not along the next tangent. (Not so
  /// where it turns far: ω then turns by as much, that of a needle that spins about itself away from its
  /// arms.)
  double chord(const Vec3& axis, const Vec3& arm) const {
    if (!along_chords_) return 0.0;
    const Vec3& omega = before_.angular_velocity;
    return 0.5 * step_ * (omega.squaredNorm() * arm.dot(axis) - omega.dot(arm) * omega.dot(axis));
  }
  void set_row(GroundContact::Row& row, const Vec3& axis, const Vec3& arm) const {
    row.axis = axis;
    row.lever = arm.cross(axis);
    row.turning = inverse_inertia_ * row.lever;
    row.effective_mass = 1.0 / (1.0 + row.lever.dot(row.turning));
    row.impulse = 0.0;
    row.target = chord(axis, arm);
  }
  void prepare(GroundContact& c) const;
  void find_tangents(GroundContact& c) const;
  static void soften(GroundContact& c);
  double share_across(const GroundContact& c) const;
  double relax(GroundContact& c, PairedMotion& motion);
  void start_from_guess(GroundContact& c);
  void sweep();
  void bound_friction();

  GroundMotion& motion_;
  GroundMotion before_;
  const Mat3& inverse_inertia_;
  std::span<GroundContact> contacts_;
  double step_;  // s
  const ContactSolverSettings& settings_;
  bool along_chords_;
};

void GroundSolver::prepare(GroundContact& c) const {
  set_row(c.rows[0], c.normal, c.arm);
  c.rows[1] = c.rows[2] = {};
  const double approach = before_.velocity_at(c.arm).dot(c.normal), closing = std::min(0.0, -c.gap / step_),
               fall = std::min(0.0, settings_.fall.dot(c.normal)),
               turned = std::min(0.0, settings_.turned.cross(c.arm).dot(c.normal));
  c.bounces = approach - turned < -settings_.bounce_velocity && c.gap + approach * step_ < 0.0;
  const double leaving = c.bounces ? bounce_in_fall(c.law.restitution, c.gap, approach, fall, step_) : 0.0;
  if (leaving > 0.0)  // then no chord keeps it in its place
    c.rows[0].target = leaving;
  else
    c.rows[0].target += c.bounces ? std::max(leaving, closing) : closing;
}

// Once it carries something: most of the points that may touch never do.
void GroundSolver::find_tangents(GroundContact& c) const {
  if (c.rows[1].effective_mass > 0.0) return;
  const Mat3 frame = contact_frame(c.normal, before_.velocity_at(c.arm));
  c.share_across = share_across(c);
  for (int i = 1; i < 3; ++i) set_row(c.rows[std::size_t(i)], frame.col(i), c.arm);
  soften(c);
}

void GroundSolver::soften(GroundContact& c) {
  const auto coupled = [&](std::size_t i, std::size_t k) { return c.rows[i].lever.dot(c.rows[k].turning); };
  const double mass[3] = {c.rows[0].effective_mass, c.rows[1].effective_mass, c.rows[2].effective_mass},
               all_coupled[3] = {coupled(0, 1), coupled(1, 2), coupled(2, 0)};
  double swing;
  find_swing(mass, all_coupled, swing);
  if (swing < 1.0) return;
  for (GroundContact::Row& row : c.rows) row.effective_mass *= 0.5;
}

// For what a torque drives alone.
double GroundSolver::share_across(const GroundContact& c) const {
  if (settings_.driven == 0.0) return 1.0;
  const auto along_ground = [&](const Vec3& v) { return Vec3(v - v.dot(c.normal) * c.normal); };
  return friction_share_across(along_ground(before_.velocity_at(c.arm)), along_ground(before_.velocity),
                               c.law.friction * settings_.driven);
}

double friction_bound(const GroundContact& c) {
  return c.friction_bound >= 0.0 ? c.friction_bound : c.law.friction * c.rows[0].impulse;
}

constexpr double kSlow = 5.0;  // over the speed from which on it slides

// Returns the size of the change, N s over mass.
inline double GroundSolver::relax(GroundContact& c, PairedMotion& motion) {
  const PairedMotion now = motion;
  const auto change_to = [&](GroundContact::Row& row, double impulse) {
    const double change = impulse - row.impulse;
    row.impulse = impulse;
    motion.apply(row, change);
    return std::abs(change);
  };
  GroundContact::Row& normal = c.rows[0];
  const double impulse =
      std::max(0.0, normal.impulse + normal.effective_mass * (normal.target - now.along(normal)));
  double changed = impulse == normal.impulse ? 0.0 : change_to(normal, impulse);
  const double bound = friction_bound(c);
  if (bound == 0.0 && c.rows[1].impulse == 0.0 && c.rows[2].impulse == 0.0) return changed;
  find_tangents(c);
  // The first tangent is the way that the point goes. What slides keeps no place: friction is bounded along
  // that way, and across it must not draw the point to the side. What is slow, and more than friction can
  // stop, is bounded by both together: else a box that is pushed high up would turn about its upright axis
  // until √2 of its friction held it.
  const double speed = now.along(c.rows[1]),
               along = c.rows[1].impulse - c.rows[1].effective_mass * (speed - c.rows[1].target);
  const bool stops = std::abs(along) <= bound, slides = !stops && std::abs(speed) > settings_.sliding_speed,
             is_slow = !stops && std::abs(speed) < kSlow * settings_.sliding_speed;
  const double aside = now.along(c.rows[2]) - (slides ? 0.0 : c.rows[2].target),
               across = c.rows[2].impulse - c.rows[2].effective_mass * aside,
               share = is_slow ? std::min(1.0, bound / std::hypot(along, across)) : 1.0;
  changed += change_to(c.rows[1], std::clamp(share * along, -bound, bound));
  changed +=
      change_to(c.rows[2], std::clamp(share * across, -c.share_across * bound, c.share_across * bound));
  return changed;
}

void GroundSolver::start_from_guess(GroundContact& c) {
  if (c.bounces || c.guess.isZero(0.0)) return;
  c.rows[0].impulse = std::max(0.0, c.guess.dot(c.normal));
  const double bound = friction_bound(c);
  if (bound > 0.0) find_tangents(c);
  for (std::size_t t = 1; t < 3; ++t)
    c.rows[t].impulse = std::clamp(c.guess.dot(c.rows[t].axis), -bound, bound);
  PairedMotion motion(motion_);
  for (const GroundContact::Row& row : c.rows) motion.apply(row, row.impulse);
  motion_ = motion.motion();
}

void GroundSolver::sweep() {
  PairedMotion motion(motion_);
  for (int i = 0; i < settings_.sweeps; ++i) {
    double changed = 0.0, greatest = 0.0;
    for (GroundContact& c : contacts_) {
      changed = std::max(changed, relax(c, motion));
      greatest = std::max(greatest, c.rows[0].impulse);
    }
    if (changed <= settings_.tolerance * greatest) break;
  }
  motion_ = motion.motion();
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
