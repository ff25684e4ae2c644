// The vector types used throughout. The world frame is right-handed, units are SI; quaternions take body axes
// to world axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace lodestone {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
// Unaligned, so that a class holding one has the same layout whatever vector instructions its user compiles
// for.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Where a body is and how it moves. `position` is the centre of mass in the world (m); `orientation` takes
/// body axes to world axes (unit norm); `velocity` of the centre of mass (m/s) and `angular_velocity` (rad/s)
/// are in the world frame.
struct RigidState {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
};

/// m, m/s and rad/s: the greatest absolute value of each coordinate of a position or velocity that a level
/// keeps; a body beyond it is put back.
inline constexpr double kStateLimit = 1e8;

/// Whether each coordinate is within kStateLimit; false for NaN.
inline bool is_within_limit(const Vec3& v) {
  return std::abs(v.x()) <= kStateLimit && std::abs(v.y()) <= kStateLimit && std::abs(v.z()) <= kStateLimit;
}

/// rad: below it Taylor series are used, exact to rounding and without a division.
inline constexpr double kSmallAngle = 0.25;
/// sin x / x, and below cos x, for x² = `square` and |x| < kSmallAngle. `Numbers` may be several side by
/// side; inlined, as these are compiled for wider registers.
template <class Numbers>
[[gnu::always_inline]] inline Numbers small_sine_over_angle(const Numbers& square) {
  return 1.0 - square * (1.0 / 6.0) *
                   (1.0 - square * (1.0 / 20.0) *
                              (1.0 - square * (1.0 / 42.0) *
                                         (1.0 - square * (1.0 / 72.0) * (1.0 - square * (1.0 / 110.0)))));
}
template <class Numbers>
[[gnu::always_inline]] inline Numbers small_cosine(const Numbers& square) {
  return 1.0 - square * 0.5 *
                   (1.0 - square * (1.0 / 12.0) *
                              (1.0 - square * (1.0 / 30.0) *
                                         (1.0 - square * (1.0 / 56.0) * (1.0 - square * (1.0 / 90.0)))));
}
/// Of any angle, rad.
inline std::pair<double, double> sine_and_cosine(double angle) {
  if (std::abs(angle) < kSmallAngle)
    return {angle * small_sine_over_angle(angle * angle), small_cosine(angle * angle)};
  return {std::sin(angle), std::cos(angle)};
}

/// The rotation by `v` radians about v's own direction (exponential map). Below half a radian, as in most
/// steps, by Taylor series, exact to rounding.
inline Quat rotation_from_vector(const Vec3& v) {
  const double h2 = 0.25 * v.squaredNorm();  // of half the angle
  if (h2 < kSmallAngle * kSmallAngle) {
    const double sinc = small_sine_over_angle(h2), cosine = small_cosine(h2);
    return Quat(cosine, 0.5 * sinc * v.x(), 0.5 * sinc * v.y(), 0.5 * sinc * v.z());
  }
  const double half = std::sqrt(h2), sinc = std::sin(half) / half;
  return Quat(std::cos(half), 0.5 * sinc * v.x(), 0.5 * sinc * v.y(), 0.5 * sinc * v.z());
}

/// The smallest rotation that takes the direction of `from` to that of `to`, which may have any length; for
/// opposite directions it is about some axis across them. Here and below not inline, since Eigen's
/// decompositions cost a file that uses them seconds of compiling.
Quat rotation_between(const Vec3& from, const Vec3& to);

/// The principal moments of a symmetric tensor, ascending, and the axes that they are about, as columns,
/// right-handed.
struct PrincipalAxes {
  Vec3 moments;
  Mat3 axes;
};
PrincipalAxes find_principal_axes(const Mat3& tensor);
Vec3 find_principal_moments(const Mat3& tensor);  ///< the moments alone, ascending

}  // namespace lodestone
