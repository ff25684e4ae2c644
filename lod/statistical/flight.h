// Motion without contact: a parabola and torque-free rotation.
#pragma once

#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// The orientation `time` seconds later; a body with a single moment of inertia turns steadily.
inline Quat advance_orientation(const Quat& orientation, const Vec3& spin, const BodyKind& kind, double time) {
  if (!kind.isotropic) return advance_orientation(orientation, spin, *kind.shape, time);
  return rotation_from_vector(angular_velocity(orientation, spin, *kind.shape) * time) * orientation;
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
