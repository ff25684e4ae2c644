#include "scenes/run_measures.h"

#include <algorithm>

namespace lodestone {

double kinetic_energy(const Shape& shape, double mass, const RigidState& state) {
  const Vec3 omega = state.orientation.conjugate() * state.angular_velocity;  // body axes, in which the inertia is constant
  return 0.5 * mass * (state.velocity.squaredNorm() + omega.dot(shape.inertia_per_mass * omega));
}

double depth_below(const Shape& shape, const RigidState& state, const Vec3& normal, double offset) {
  const double height = normal.dot(state.position) - offset;
  if (shape.sphere_radius) return *shape.sphere_radius - height;
  if (height > shape.radius) return shape.radius - height;  // clear of the plane whatever way it is turned: a bound is enough
  const Vec3 down = state.orientation.conjugate() * Vec3(-normal);
  const int lowest = find_support(shape.hull, down, shape.support_map.find_start(down));
  return down.dot(shape.hull.vertices[std::size_t(lowest)]) - height;
}

bool is_finite(const RigidState& state) {
  return state.position.allFinite() && state.orientation.coeffs().allFinite() && state.velocity.allFinite() &&
         state.angular_velocity.allFinite();
}

void read_sample(const Manager& manager, std::span<const BodyId> bodies, const Scene& scene, RunSample& sample) {
  sample.states.resize(bodies.size());
  sample.levels.resize(bodies.size());
  sample.energy_j = sample.max_penetration_m = 0;
  sample.finite = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RigidState state = sample.states[i] = manager.state(bodies[i]);
    sample.levels[i] = manager.level(bodies[i]);
    if (!is_finite(state)) {
      sample.finite = false;
      continue;
    }
    const Shape& shape = *scene.bodies[i].definition.shape;
    const double mass = manager.mass(bodies[i]);
    sample.energy_j += kinetic_energy(shape, mass, state) - mass * scene.step.gravity_m_per_s2.dot(state.position);
    for (const Ground& ground : scene.ground)
      if (const auto* plane = std::get_if<GroundPlane>(&ground))
        sample.max_penetration_m = std::max(sample.max_penetration_m, depth_below(shape, state, plane->normal, plane->offset_m));
  }
}

}  // namespace lodestone
