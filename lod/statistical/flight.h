// Motion without contact: a parabola and torque-free rotation.
#pragma once

#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// Turns `axes` (principal axes to world) about its own axis `Axis` by `angle` rad; `spin` is the angular momentum in these axes.
template <int Axis>
inline void turn_about_own(double angle, Quat& axes, Vec3& spin) {
  constexpr int kNext = (Axis + 1) % 3, kLast = (Axis + 2) % 3;
  const double half = 0.5 * angle;
  const auto [sine, cosine] = sine_and_cosine(half);
  const double w = axes.w(), own = axes.vec()[Axis], next = axes.vec()[kNext], last = axes.vec()[kLast];
  axes.w() = w * cosine - own * sine;
  axes.vec()[Axis] = own * cosine + w * sine;
  axes.vec()[kNext] = next * cosine + last * sine;
  axes.vec()[kLast] = last * cosine - next * sine;
  const double whole_sine = 2.0 * sine * cosine, whole_cosine = 1.0 - 2.0 * sine * sine, at_next = spin[kNext], at_last = spin[kLast];
  spin[kNext] = at_next * whole_cosine + at_last * whole_sine;
  spin[kLast] = at_last * whole_cosine - at_next * whole_sine;
}

/// The orientation `time` seconds later in free rotation, by splitting the kinetic energy into that of a ball with the middle moment and those of the other two
/// axes (Touma and Wisdom, Lie–Poisson integrators for rigid body dynamics in the solar system, 1994). Each part is solved exactly, so the whole
/// is exact where two moments are equal, however slender the body, of second order else, and its energy does not drift.
inline Quat advance_orientation(const Quat& orientation, const Vec3& spin, const BodyKind& kind, double time) {
  const Vec3& inverse = kind.inverse_moments;
  const Quat of_ball = rotation_from_vector(spin * (inverse[1] * time));
  if (kind.isotropic) return of_ball * orientation;
  Quat axes = kind.along_principal_axes ? orientation : Quat(orientation * kind.principal_axes);
  Vec3 own = axes.conjugate() * spin;
  turn_about_own<0>((inverse[0] - inverse[1]) * own[0] * (0.5 * time), axes, own);
  turn_about_own<2>((inverse[2] - inverse[1]) * own[2] * time, axes, own);
  turn_about_own<0>((inverse[0] - inverse[1]) * own[0] * (0.5 * time), axes, own);
  return of_ball * (kind.along_principal_axes ? axes : Quat(axes * kind.principal_axes.conjugate()));
}

/// Moves `body` along its free flight for `time` seconds. Exact for the centre of mass.
inline void advance_flight(StatisticalBody& body, const BodyKind& kind, const Vec3& gravity, double time) {
  body.position += (body.velocity + gravity * (0.5 * time)) * time;
  body.velocity += gravity * time;
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time);
  // Renormalising without a square root: one Newton step is exact to rounding for a norm already within 1e-8 of 1.
  body.orientation.coeffs() *= 1.5 - 0.5 * body.orientation.squaredNorm();
}

/// Moves a kinematic body by `time` seconds: steadily, whatever its shape.
inline void advance_kinematic(StatisticalBody& body, const BodyKind& kind, double time) {
  const Vec3 omega = angular_velocity(body.orientation, body.spin, *kind.shape);
  body.position += body.velocity * time;
  body.orientation = (rotation_from_vector(omega * time) * body.orientation).normalized();
  body.spin = spin_of(body.orientation, omega, *kind.shape);
}

}  // namespace lodestone
