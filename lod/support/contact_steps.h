// How a hull slides, rolls and rocks on the ground: in steps of its own, contact steps, in each of which
// every vertex near the ground is held at once (contact_stepper.h).
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// Moves a body that touches the ground by `time` seconds; what it touched and met is added to `tally`.
void move_on_ground(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                    const SupportSettings& settings, ContactTally& tally);

}  // namespace lodestone
