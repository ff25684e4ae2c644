// What is observed of all bodies of a running scene, outside of its timed steps.
#pragma once

#include <span>
#include <vector>

#include "scenes/camera.h"
#include "scenes/scene.h"

namespace lodestone {

/// Samples awake in which a body that comes from `tables` may still be as deep as its sphere was.
inline constexpr int kSinking = 30;

/// The bodies of a manager, read once a step.
struct RunSample {
  std::vector<RigidState> states;
  std::vector<Rung> rungs;
  /// Samples in which the body was awake since it was at `tables`, at most kSinking.
  std::vector<int> awake_since_tables;
  double energy_j = 0;  ///< kinetic, and potential about the origin
  /// Below any ground plane of the scene: of bodies at `tables`, or fewer than kSinking awake_since_tables.
  double max_tables_penetration_m = 0;
  double max_other_penetration_m = 0;  ///< of all others
  bool finite = true;                  ///< where not, the three above are of the finite bodies only
};

/// Reads `bodies` (those of `scene`, in its order) into `sample`.
void read_sample(const Manager& manager, std::span<const BodyId> bodies, const Scene& scene,
                 RunSample& sample);

/// Whose centre of mass the camera sees.
int count_full_in_picture(const RunSample& sample, const Camera& camera);

}  // namespace lodestone
