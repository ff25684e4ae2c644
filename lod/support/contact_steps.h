// How a hull slides, rolls and rocks on the ground: in steps, every vertex near the ground held at once.
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// Moves a body that touches the ground by `time` seconds.
void move_on_ground(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                    const SupportSettings& settings, ContactTally& tally);

}  // namespace lodestone
