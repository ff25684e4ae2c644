#include "scenes/run_measures.h"

namespace lodestone {

double kinetic_energy(const Shape& shape, double mass, const RigidState& state) {
  const Vec3 omega =
      state.orientation.conjugate() * state.angular_velocity;  // body axes, in which the inertia is constant
  return 0.5 * mass * (state.velocity.squaredNorm() + omega.dot(shape.inertia_per_mass * omega));
}

double depth_below(const Shape& shape, const RigidState& state, const Vec3& normal, double offset) {
  const double height = normal.dot(state.position) - offset;
  if (shape.sphere_radius) return *shape.sphere_radius - height;
  if (height > shape.radius)
    return shape.radius - height;  // clear of the plane whatever way it is turned: a bound is enough
  const Vec3 down = state.orientation.conjugate() * Vec3(-normal);
  const int lowest = find_support(shape.hull, down, shape.support_map.find_start(down));
  return down.dot(shape.hull.vertices[std::size_t(lowest)]) - height;
}

bool is_finite(const RigidState& state) {
  return state.position.allFinite() && state.orientation.coeffs().allFinite() && state.velocity.allFinite() &&
         state.angular_velocity.allFinite();
}

}  // namespace lodestone
