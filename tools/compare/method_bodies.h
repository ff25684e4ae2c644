// What a method's bodies are to the engine that it runs in: one definition for drops and piles.
#pragma once

#include <cstdint>

#include "tools/compare/drop_method.h"

namespace lodestone {

/// With the signature of `method`, which is the only one that any body needs.
ManagerSettings manager_settings_of(const StatisticalMethod& method, std::uint64_t seed);

BodyDefinition statistical_body_of(const DropJob& job, const RigidState& state);
OdeBodyDefinition ode_body_of(const DropJob& job, const OdeMethod& way, const RigidState& state);
BulletBodyDefinition bullet_body_of(const DropJob& job, const BulletMethod& way, const RigidState& state);

}  // namespace lodestone
