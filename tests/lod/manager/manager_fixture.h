// Managers on a floor, in a statement or two.
#pragma once

#include "lod/manager.h"
#include "signature/measure/measure.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::testing {

inline constexpr double kFrame = 1.0 / 60.0;  // s

inline std::shared_ptr<const Signature> no_signature(const Shape&, const ContactLaw&) { return nullptr; }

/// Measured in a moment: enough for `tables` to run.
inline std::shared_ptr<const Signature> coarse_signature(const Shape& shape, const ContactLaw&) {
  SignatureSettings coarse;
  coarse.n_theta = 4, coarse.n_phi = 4, coarse.n_alpha = 6, coarse.trials_per_cell = 8,
  coarse.height_trials = 100, coarse.settling_trials = 20, coarse.clips = 10, coarse.held_out_conditions = 4;
  return std::make_shared<const Signature>(measure_signature(shape, coarse, 1));
}

/// Signatures are not measured: the statistical bodies are those of `support` without settling clips.
inline ManagerSettings unmeasured(const PolicySettings& policy = {}) {
  return {.policy = policy, .signatures = no_signature};
}

inline Manager on_floor(const ManagerSettings& settings = unmeasured()) {
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  return manager;
}

inline BodyId add(Manager& manager, const std::shared_ptr<const Shape>& shape, const RigidState& state,
                  LevelChoice level = LevelChoice::automatic) {
  return manager.add_body({.shape = shape, .state = state, .level = level});
}

inline void view_from(Manager& manager, const Vec3& viewpoint) { manager.set_viewpoints({&viewpoint, 1}); }

inline void run(Manager& manager, double seconds) {
  for (int i = 0; i < int(std::lround(seconds / kFrame)); ++i) manager.step(kFrame);
}

inline double energy(const Manager& manager, BodyId body) {
  return energy_of(manager.shape(body), manager.mass(body), manager.state(body));
}

}  // namespace lodestone::testing
