#include "scenes/run_sample.h"

#include <algorithm>

#include "scenes/run_measures.h"

namespace lodestone {

void read_sample(const Manager& manager, std::span<const BodyId> bodies, const Scene& scene,
                 RunSample& sample) {
  sample.states.resize(bodies.size());
  sample.rungs.resize(bodies.size());
  sample.awake_since_tables.resize(bodies.size(), kSinking);
  sample.energy_j = sample.max_tables_penetration_m = sample.max_other_penetration_m = 0;
  sample.finite = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RigidState state = sample.states[i] = manager.state(bodies[i]);
    sample.rungs[i] = manager.rung(bodies[i]);
    if (!is_finite(state)) {
      sample.finite = false;
      continue;
    }
    const Shape& shape = *scene.bodies[i].definition.shape;
    const double mass = manager.mass(bodies[i]);
    sample.energy_j +=
        kinetic_energy(shape, mass, state) - mass * scene.step.gravity_m_per_s2.dot(state.position);
    int& awake_since_tables = sample.awake_since_tables[i];
    if (sample.rungs[i] == Rung::tables)
      awake_since_tables = 0;
    else if (!manager.asleep(bodies[i]))
      awake_since_tables = std::min(awake_since_tables + 1, kSinking);
    double& deepest =
        awake_since_tables < kSinking ? sample.max_tables_penetration_m : sample.max_other_penetration_m;
    for (const SceneGround& ground : scene.ground)
      if (const auto* plane = std::get_if<GroundPlane>(&ground))
        deepest = std::max(deepest, depth_below(shape, state, plane->normal, plane->offset_m));
      else if (const auto* box = std::get_if<GroundBox>(&ground))
        deepest =
            std::max(deepest, depth_in_box(shape, state, box->sides_m,
                                           {.position = box->position_m, .orientation = box->orientation}));
  }
}

int count_full_in_picture(const RunSample& sample, const Camera& camera) {
  int count = 0;
  for (std::size_t i = 0; i < sample.states.size(); ++i)
    count += sample.rungs[i] == Rung::full && camera.sees(sample.states[i].position);
  return count;
}

}  // namespace lodestone
