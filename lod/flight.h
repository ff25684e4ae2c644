// Motion without contact: a parabola and torque-free rotation. The angular momentum is the state, so it is conserved exactly; the
// orientation follows by the explicit midpoint rule on the rotation group (second order).
#pragma once

#include "lod/statistical_body.h"

namespace lodestone {

/// The orientation `time` seconds later.
inline Quat advance_orientation(const Quat& orientation, const Vec3& spin, const BodyKind& kind, double time) {
  const Vec3 now = angular_velocity(orientation, spin, *kind.shape);
  if (kind.isotropic) return rotation_from_vector(now * time) * orientation;
  const Quat middle = rotation_from_vector(now * (0.5 * time)) * orientation;
  return rotation_from_vector(angular_velocity(middle, spin, *kind.shape) * time) * orientation;
}

/// Moves `body` along its free flight for `time` seconds. Exact for the centre of mass.
inline void advance_flight(StatisticalBody& body, const BodyKind& kind, const Vec3& gravity, double time) {
  body.position += (body.velocity + gravity * (0.5 * time)) * time;
  body.velocity += gravity * time;
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time);
  // Renormalising without a square root: one Newton step is exact to rounding for a norm already within 1e-8 of 1.
  body.orientation.coeffs() *= 1.5 - 0.5 * body.orientation.squaredNorm();
}

}  // namespace lodestone
