// A manager in which a scene's world is: its ground, its bodies and their joints, and who looks at them.
#pragma once

#include <vector>

#include "scenes/run_settings.h"

namespace lodestone {

/// The scene's, or what the settings have in its place.
PolicySettings policy_of(const Scene& scene, const RunSettings& settings);

/// Empty but for the ground. `signatures`: empty, or what the manager asks.
Manager make_manager(const Scene& scene, const RunSettings& settings, const SignatureFunction& signatures);

/// All bodies of the scene in its order, their joints and groups; `level`, where it is not automatic, is that
/// of all that no joint needs full.
std::vector<BodyId> add_scene_bodies(Manager& manager, const Scene& scene, LevelChoice level);

/// Where the scene's viewpoints are then.
void move_viewpoints(Manager& manager, const Scene& scene, double time_s);

}  // namespace lodestone
