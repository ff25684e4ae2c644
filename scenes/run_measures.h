// What is observed of a running scene, outside of its timed steps: energy, penetration and whether every number is still finite.
#pragma once

#include <span>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

/// ½ m v² + ½ ωᵀ I ω, J, with the shape's true inertia.
double kinetic_energy(const Shape& shape, double mass, const RigidState& state);

/// How far the deepest vertex lies below the plane normal·x = offset (normal of unit length), m; negative above it.
double depth_below(const Shape& shape, const RigidState& state, const Vec3& normal, double offset);

bool is_finite(const RigidState& state);

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
