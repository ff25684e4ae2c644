#include "scenes/run_measures.h"

#include <algorithm>

#include "reference/free_rotation.h"

namespace lodestone {

double kinetic_energy(const Shape& shape, double mass, const RigidState& state) {
  return mass * kinetic_energy(shape, state);
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

double depth_in_box(const Shape& shape, const RigidState& state, const Vec3& sides, const RigidState& box) {
  const Quat to_box = box.orientation.conjugate();
  const Vec3 half = 0.5 * sides, center = to_box * (state.position - box.position);
  const auto depth_of = [&](const Vec3& point) { return (half - point.cwiseAbs()).minCoeff(); };
  if (shape.sphere_radius) {  // beside an edge or a corner it is farther away than from either face
    const Vec3 outside = (center.cwiseAbs() - half).cwiseMax(0.0);
    return *shape.sphere_radius + (outside.isZero(0.0) ? depth_of(center) : -outside.norm());
  }
  const double deepest = depth_of(center) + shape.radius;  // of any of its points, at most
  if (deepest <= 0.0) return deepest;
  const Quat turn = to_box * state.orientation;
  double depth = -shape.radius;
  for (const Vec3& vertex : shape.hull.vertices) depth = std::max(depth, depth_of(center + turn * vertex));
  return depth;
}

bool is_finite(const RigidState& state) {
  return state.position.allFinite() && state.orientation.coeffs().allFinite() && state.velocity.allFinite() &&
         state.angular_velocity.allFinite();
}

}  // namespace lodestone
