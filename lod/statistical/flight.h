// Motion without contact: a parabola and torque-free rotation.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// Turns `axes` (principal axes to world) about its own axis `Axis` by `angle` rad; `spin` is the angular
/// momentum in these axes.
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
  const double whole_sine = 2.0 * sine * cosine, whole_cosine = 1.0 - 2.0 * sine * sine,
               at_next = spin[kNext], at_last = spin[kLast];
  spin[kNext] = at_next * whole_cosine + at_last * whole_sine;
  spin[kLast] = at_last * whole_cosine - at_next * whole_sine;
}

/// Half the turn, as the tangent times the axis, that takes `own` to the direction of `to`, which is less
/// than a right angle from it.
inline Vec3 half_tangent(const Vec3& own, const Vec3& to) {
  const double along = own.dot(to);
  return own.cross(to) / (along + std::sqrt(own.squaredNorm() * to.squaredNorm()));
}

/// The turn, in principal axes and as half_tangent gives it, after which the angular momentum `own` (m²/s,
/// these axes) has the energy of a free rotation: `twice_energy` = own·I⁻¹own (J/kg). On the great circle
/// through own along which that changes fastest it is a quadratic form, solved exactly; where that circle
/// does not reach the energy, the one through the pole of the least or greatest energy does.
inline Vec3 turn_to_energy(const Vec3& own, const Vec3& inverse_moments, double twice_energy) {
  const Vec3 omega = inverse_moments.cwiseProduct(own);  // rad/s
  const double now = own.dot(omega), excess = now - twice_energy, square = own.squaredNorm();
  if (!(std::abs(excess) > 1e-14 * now)) return Vec3::Zero();
  const double inverse_square = 1.0 / square;
  const Vec3 across = omega - (now * inverse_square) * own;
  const double slope = across.squaredNorm();  // half the derivative of (own + x across)·I⁻¹(own + x across)
  if (slope * square > 1e-18 * now * now) {
    const double curve =
        across.dot(inverse_moments.cwiseProduct(across)) - twice_energy * slope * inverse_square;
    const double inverse_slope = 1.0 / slope, bend = curve * excess * inverse_slope * inverse_slope;
    if (bend <= 1.0) {
      // x = −excess / (slope (1 + √(1 − bend))), and half the angle whose tangent is x |across| / |own|;
      // small ones by their series
      const bool small = std::abs(bend) < 1e-3;
      const double x = -excess * inverse_slope *
                       (small ? 0.5 + bend * (0.125 + 0.0625 * bend) : 1.0 / (1.0 + std::sqrt(1.0 - bend)));
      const double t = x * x * slope * inverse_square;
      return own.cross(omega) *
             (x * inverse_square *
              (t < 1e-4 ? 0.5 - t * (0.125 - 0.0625 * t) : 1.0 / (1.0 + std::sqrt(1.0 + t))));
    }
  }
  const int pole = excess > 0.0 ? 0 : 2;
  const double of_pole = inverse_moments[pole] * square,
               share =
                   now != of_pole ? std::clamp((twice_energy - of_pole) / (now - of_pole), 0.0, 1.0) : 0.0;
  Vec3 to = std::sqrt(share) * own;
  to[pole] =
      std::copysign(std::sqrt(std::max(0.0, square - share * (square - own[pole] * own[pole]))), own[pole]);
  return half_tangent(own, to);
}

/// `axes` (principal axes to world) after what turns the angular momentum in them by `half`, as half_tangent
/// gives it.
inline Quat turned_back(const Quat& axes, const Vec3& half) {
  const double square = half.squaredNorm();
  Quat turned = axes * Quat(1.0, -half.x(), -half.y(), -half.z());
  turned.coeffs() *= square < 1e-5 ? 1.0 - square * (0.5 - 0.375 * square) : 1.0 / std::sqrt(1.0 + square);
  return turned;
}

/// Angle (rad) by which the other two axes' parts may turn a body in one round of the splitting, and the
/// rounds at most.
inline constexpr double kTurnOfRound = 0.5;
inline constexpr int kMostRounds = 16;
/// rad: a smaller one changes the energy by less than 1e-12 of it, as its third power.
inline constexpr double kNoTurn = 1e-4;

/// The orientation `time` seconds later in free rotation, by splitting the kinetic energy into that of a ball
/// with the middle moment and those of the other two axes (Touma and Wisdom, Lie–Poisson integrators for
/// rigid body dynamics in the solar system, 1994). Each part is solved exactly, so the whole is exact where
/// two moments are equal, however slender the body, of second order else; a fast turn takes several rounds.
/// The angular momentum is kept to rounding, and so is the energy, by a turn at the end (turn_to_energy):
/// twice it is `twice_energy` (J/kg), where given, else what it has.
inline Quat advance_orientation(const Quat& orientation, const Vec3& spin, const BodyKind& kind, double time,
                                std::optional<double> twice_energy = {}) {
  const Vec3& inverse = kind.inverse_moments;
  const Quat of_ball = rotation_from_vector(spin * (inverse[1] * time));
  if (kind.isotropic) return of_ball * orientation;
  Quat axes = kind.along_principal_axes ? orientation : Quat(orientation * kind.principal_axes);
  Vec3 own = axes.conjugate() * spin;
  const double asked = twice_energy.value_or(own.dot(inverse.cwiseProduct(own)));
  const double widest = std::max(inverse[1] - inverse[0], inverse[2] - inverse[1]) * time,
               angle_squared = own.squaredNorm() * widest * widest;
  int rounds = 1;
  if (angle_squared > kTurnOfRound * kTurnOfRound)
    rounds = int(std::min(double(kMostRounds), std::ceil(std::sqrt(angle_squared) / kTurnOfRound)));
  const double part = time / rounds;
  for (int round = 0; round < rounds; ++round) {
    turn_about_own<0>((inverse[0] - inverse[1]) * own[0] * (0.5 * part), axes, own);
    turn_about_own<2>((inverse[2] - inverse[1]) * own[2] * part, axes, own);
    turn_about_own<0>((inverse[0] - inverse[1]) * own[0] * (0.5 * part), axes, own);
  }
  if (twice_energy || angle_squared > kNoTurn * kNoTurn)
    axes = turned_back(axes, turn_to_energy(own, inverse, asked));
  return of_ball * (kind.along_principal_axes ? axes : Quat(axes * kind.principal_axes.conjugate()));
}

/// How a body turns freely, in its own axes: ω and, by Euler's equations, I⁻¹ (L × ω).
struct OwnTurning {
  Vec3 rate = Vec3::Zero(), acceleration = Vec3::Zero();  ///< rad/s, rad/s²
};
inline OwnTurning find_own_turning(const Quat& orientation, const Vec3& spin, const Shape& shape) {
  const Vec3 own = orientation.conjugate() * spin, rate = shape.inverse_inertia_per_mass * own;
  return {rate, shape.inverse_inertia_per_mass * own.cross(rate)};
}

/// The orientation `time` seconds later to second order, a few times as quick as advance_orientation: the
/// energy is off by the third power of the angle, which is to be small.
inline Quat turned_shortly(const Quat& orientation, const OwnTurning& turning, double time) {
  return orientation * rotation_from_vector((turning.rate + turning.acceleration * (0.5 * time)) * time);
}

/// Moves `body` along its free flight for `time` seconds. Exact for the centre of mass.
inline void advance_flight(StatisticalBody& body, const BodyKind& kind, const Vec3& gravity, double time) {
  body.position += (body.velocity + gravity * (0.5 * time)) * time;
  body.velocity += gravity * time;
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time);
  // Renormalising without a square root: one Newton step is exact to rounding for a norm already within 1e-8
  // of 1.
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
