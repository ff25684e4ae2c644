// Sequential impulses in the plainest way, one contact after the other: what the solvers are held to.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "lod/contact/contact_impulse.h"
#include "lod/contact/contact_solver.h"

namespace lodestone {

struct PlainContact {
  std::int32_t first = 0, second = -1;  // second −1: the ground
  Vec3 normal = Vec3::UnitZ();          // points into `first`
  Vec3 arm_first = Vec3::Zero(), arm_second = Vec3::Zero();
  double gap = 0.0;  // m
  ContactLaw law;
  Vec3 guess = Vec3::Zero();  // N s, on `first`
  // Filled by the solver:
  Mat3 frame = Mat3::Zero();
  double target = 0.0, bound = -1.0;  // m/s; N s, negative: by the normal impulse as it is
  bool bounces = false;
  Vec3 along_axes = Vec3::Zero();  // N s
  Vec3 impulse() const { return frame * along_axes; }
};

class PlainSolver {
 public:
  PlainSolver(std::span<SolverBody> bodies, std::span<PlainContact> contacts, double step,
              const ContactSolverSettings& settings)
      : bodies_(bodies), contacts_(contacts), settings_(settings) {
    for (PlainContact& c : contacts_) prepare(c, step);
  }
  void solve() {
    if (settings_.frictionless_bound) {
      const std::vector<SolverBody> before(bodies_.begin(), bodies_.end());
      for (PlainContact& c : contacts_) c.bound = 0.0;
      run();
      for (PlainContact& c : contacts_) c.bound = c.law.friction * c.along_axes[0];
      std::ranges::copy(before, bodies_.begin());
    }
    run();
  }

 private:
  Vec3 velocity(const PlainContact& c) const {
    const SolverBody& a = bodies_[std::size_t(c.first)];
    const Vec3 of_first = a.velocity + a.angular_velocity.cross(c.arm_first);
    if (c.second < 0) return of_first;
    const SolverBody& b = bodies_[std::size_t(c.second)];
    return of_first - b.velocity - b.angular_velocity.cross(c.arm_second);
  }
  void prepare(PlainContact& c, double step) const {
    const Vec3 v = velocity(c);
    c.frame = contact_frame(c.normal, v);
    const bool on_still = c.second < 0 || bodies_[std::size_t(c.second)].inverse_mass == 0.0;
    const double approach = v.dot(c.normal), closing = std::min(0.0, -c.gap / step),
                 fall = on_still ? std::min(0.0, settings_.fall.dot(c.normal)) : 0.0;
    c.bounces = approach < -settings_.bounce_velocity && c.gap + approach * step < 0.0;
    c.target = c.bounces ? std::max(bounce_in_fall(c.law.restitution, c.gap, approach, fall, step), closing)
                         : closing;
  }
  void give(const PlainContact& c, const Vec3& impulse) {
    SolverBody& a = bodies_[std::size_t(c.first)];
    a.velocity += a.inverse_mass * impulse;
    a.angular_velocity += a.inverse_inertia * c.arm_first.cross(impulse);
    if (c.second < 0) return;
    SolverBody& b = bodies_[std::size_t(c.second)];
    b.velocity -= b.inverse_mass * impulse;
    b.angular_velocity -= b.inverse_inertia * c.arm_second.cross(impulse);
  }
  double inverse_mass_along(const PlainContact& c, const Vec3& axis) const {
    const auto of = [&](std::int32_t body, const Vec3& arm) {
      if (body < 0) return 0.0;
      const SolverBody& b = bodies_[std::size_t(body)];
      const Vec3 lever = arm.cross(axis);
      return b.inverse_mass + lever.dot(b.inverse_inertia * lever);
    };
    return of(c.first, c.arm_first) + of(c.second, c.arm_second);
  }
  double bound(const PlainContact& c) const {
    return c.bound >= 0.0 ? c.bound : c.law.friction * c.along_axes[0];
  }
  // Returns the size of the change.
  double relax(PlainContact& c) {
    const Vec3 v = c.frame.transpose() * velocity(c), held = c.along_axes;
    const auto asked = [&](int axis, double target) {
      const double inverse = inverse_mass_along(c, c.frame.col(axis));
      return inverse > 0.0 ? held[axis] + (target - v[axis]) / inverse : held[axis];
    };
    c.along_axes[0] = std::max(0.0, asked(0, c.target));
    for (int t = 1; t < 3; ++t) c.along_axes[t] = std::clamp(asked(t, 0.0), -bound(c), bound(c));
    give(c, c.frame * (c.along_axes - held));
    return (c.along_axes - held).lpNorm<1>();
  }
  void run() {
    for (PlainContact& c : contacts_) {
      c.along_axes.setZero();
      if (c.bounces) continue;
      const Vec3 guess = c.frame.transpose() * c.guess;
      c.along_axes[0] = std::max(0.0, guess[0]);
      for (int t = 1; t < 3; ++t) c.along_axes[t] = std::clamp(guess[t], -bound(c), bound(c));
      give(c, c.impulse());
    }
    for (int i = 0; i < settings_.sweeps; ++i) {
      double changed = 0.0, greatest = 0.0;
      for (PlainContact& c : contacts_) {
        changed = std::max(changed, relax(c));
        greatest = std::max(greatest, c.along_axes[0]);
      }
      if (changed <= settings_.tolerance * greatest) return;
    }
  }

  std::span<SolverBody> bodies_;
  std::span<PlainContact> contacts_;
  const ContactSolverSettings& settings_;
};

inline void solve_plainly(std::span<SolverBody> bodies, std::span<PlainContact> contacts, double step,
                          const ContactSolverSettings& settings) {
  PlainSolver(bodies, contacts, step, settings).solve();
}

}  // namespace lodestone
