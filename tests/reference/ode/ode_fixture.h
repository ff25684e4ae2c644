// A world on a floor, in a statement or two.
#pragma once

#include <memory>

#include "reference/ode/ode_world.h"
#include "reference/shape.h"

namespace lodestone::testing {

inline constexpr double kGravity = 9.81;

inline std::shared_ptr<const Shape> box_shape(const Vec3& sides) {
  return std::make_shared<const Shape>(make_shape("box", make_box(sides)));
}

inline std::shared_ptr<const Shape> sphere_shape(double radius) {
  return std::make_shared<const Shape>(make_sphere_shape(radius));
}

inline RigidState at(const Vec3& position, const Vec3& velocity = Vec3::Zero(),
                     const Vec3& spin = Vec3::Zero(), const Quat& orientation = Quat::Identity()) {
  return {position, orientation, velocity, spin};
}

inline MaterialTable material(double restitution, double friction) {
  MaterialTable table;
  table.replace(0, {.restitution = restitution, .friction = friction});
  return table;
}

/// Kinetic and potential energy of one body (J), the latter over the plane z = 0.
inline double energy_of(const Shape& shape, double mass, const RigidState& state) {
  const Vec3 spin = state.orientation.conjugate() * state.angular_velocity;
  return 0.5 * mass * (state.velocity.squaredNorm() + spin.dot(shape.inertia_per_mass * spin)) +
         mass * kGravity * state.position.z();
}

inline bool same_bits(const RigidState& a, const RigidState& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs() &&
         a.velocity == b.velocity && a.angular_velocity == b.angular_velocity;
}

}  // namespace lodestone::testing
