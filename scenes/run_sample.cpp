#include "scenes/run_sample.h"

#include <algorithm>

#include "scenes/run_measures.h"

namespace lodestone {

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
