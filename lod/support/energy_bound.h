// Of a body that touches the ground: it gains no energy by being put where it is not.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// What moves a body up that rolls onto vertices that did not carry it slows it down, if by no more than half
/// of its kinetic energy. (On an edge or a face it turns about what carries it: there ODE's law has all of
/// it, and what is taken for nothing but rounding keeps a pillar next to balance from falling.) One that
/// parts from what it overlapped when it came is moved by no motion of its own.
class EnergyBound {
 public:
  EnergyBound(StatisticalBody& body, const Shape& shape, const Vec3& gravity, bool bounded)
      : body_(body), shape_(shape), gravity_(gravity), bounded_(bounded && body.eased <= 0.0f) {
    if (bounded_) kinetic_ = kinetic_energy(body, shape), position_ = body.position;
  }
  /// Takes from the motion by what kinetic and potential energy exceed what they were. Where the ground has
  /// no friction, its `normal` given, not from what nothing there can change: the motion along it, the spin
  /// about the normal.
  void keep(const std::optional<Vec3>& normal = {}) {
    if (!bounded_) return;
    const double now = kinetic_energy(body_, shape_),
                 gain = now - kinetic_ - gravity_.dot(body_.position - position_);
    if (!(gain > 0.0 && now > 0.0)) return;
    if (!normal) {
      const double share = share_left(gain, now);
      body_.velocity *= share;
      body_.spin *= share;
      return;
    }
    const Vec3 rising = body_.velocity.dot(*normal) * *normal,
               rocking = body_.spin - body_.spin.dot(*normal) * *normal;
    const double taken =
        1.0 - share_left(gain, 0.5 * (rising.squaredNorm() +
                                      rocking.dot(angular_velocity(body_.orientation, rocking, shape_))));
    body_.velocity -= taken * rising;
    body_.spin -= taken * rocking;
  }

 private:
  /// Of a motion of the energy `kinetic`, both over mass.
  static double share_left(double gain, double kinetic) {
    return kinetic > 0.0 ? std::sqrt(1.0 - std::min(0.5, gain / kinetic)) : 1.0;
  }

  StatisticalBody& body_;
  const Shape& shape_;
  const Vec3& gravity_;
  bool bounded_;
  double kinetic_ = 0.0;          // J/kg, before
  Vec3 position_ = Vec3::Zero();  // m, before
};

}  // namespace lodestone
