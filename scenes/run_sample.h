// What is observed of all bodies of a running scene, outside of its timed steps.
#pragma once

#include <span>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

/// The bodies of a manager, read once a step.
struct RunSample {
  std::vector<RigidState> states;
  std::vector<Level> levels;
  double energy_j = 0;           ///< kinetic, and potential about the origin
  double max_penetration_m = 0;  ///< below any ground plane of the scene
  bool finite = true;            ///< where not, the two above are of the finite bodies only
};

/// Reads `bodies` (those of `scene`, in its order) into `sample`.
void read_sample(const Manager& manager, std::span<const BodyId> bodies, const Scene& scene, RunSample& sample);

}  // namespace lodestone
