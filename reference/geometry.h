// The vector types used throughout. World frame right-handed, SI units; quaternions map body axes to world axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace lodestone {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
// Unaligned, so that a class holding one has the same layout whatever vector instructions its user compiles for.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Where a body is and how it moves. `position` is the centre of mass in the world (m); `orientation` takes
/// body axes to world axes (unit norm); `velocity` of the centre of mass (m/s) and `angular_velocity` (rad/s) are in the world frame.
struct RigidState {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
};

/// m, m/s and rad/s, in each part of a state: beyond it no level holds a body.
inline constexpr double kStateLimit = 1e8;

/// False for NaN.
inline bool is_within_limit(const Vec3& v) {
  return std::abs(v.x()) <= kStateLimit && std::abs(v.y()) <= kStateLimit && std::abs(v.z()) <= kStateLimit;
}

/// The rotation by `v` radians about v's own direction (exponential map).
inline Quat rotation_from_vector(const Vec3& v) {
  const double angle = v.norm();
  const double half_sinc = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5 - angle * angle / 48.0;
  return Quat(std::cos(0.5 * angle), half_sinc * v.x(), half_sinc * v.y(), half_sinc * v.z());
}

}  // namespace lodestone
