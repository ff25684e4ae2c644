// Torque-free rotation of a rigid body. The spin (angular momentum over mass, world axes) is the state, so it
// is conserved exactly; the orientation follows by the explicit midpoint rule on the rotation group (second
// order).
#pragma once

#include "reference/shape.h"

namespace lodestone {

/// ω = R I⁻¹ Rᵀ L, rad/s, for spin L (m²/s).
inline Vec3 angular_velocity(const Quat& orientation, const Vec3& spin, const Shape& shape) {
  const Mat3 r = orientation.toRotationMatrix();
  return r * (shape.inverse_inertia_per_mass * (r.transpose() * spin));
}

/// L = R I Rᵀ ω.
inline Vec3 spin_of(const Quat& orientation, const Vec3& angular_velocity, const Shape& shape) {
  const Mat3 r = orientation.toRotationMatrix();
  return r * (shape.inertia_per_mass * (r.transpose() * angular_velocity));
}

inline Mat3 inverse_inertia_world(const Quat& orientation, const Shape& shape) {
  const Mat3 r = orientation.toRotationMatrix();
  return r * shape.inverse_inertia_per_mass * r.transpose();
}

/// Kinetic energy over mass, J/kg.
inline double kinetic_energy(const Shape& shape, const RigidState& s) {
  return 0.5 * (s.velocity.squaredNorm() +
                s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, shape)));
}

/// The orientation `time` seconds later.
inline Quat advance_orientation(const Quat& orientation, const Vec3& spin, const Shape& shape, double time) {
  const Vec3 now = angular_velocity(orientation, spin, shape);
  const Quat middle = rotation_from_vector(now * (0.5 * time)) * orientation;
  return rotation_from_vector(angular_velocity(middle, spin, shape) * time) * orientation;
}

}  // namespace lodestone
