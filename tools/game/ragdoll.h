// Somebody to drop: eleven bodies of the manager, full for good, on ODE's joints.
#pragma once

#include <lodestone/lodestone.h>
#include <ode/ode.h>

#include <vector>

namespace game {

/// Standing, the middle of the pelvis at `pelvis` (m). The joints are the world's and go with it.
std::vector<lodestone::BodyId> add_ragdoll(lodestone::Manager& manager, dWorldID world,
                                           const lodestone::Vec3& pelvis, const lodestone::Quat& orientation,
                                           lodestone::MaterialId material);

}  // namespace game
