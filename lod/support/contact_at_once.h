// How a hull of long edges slides and rocks on planes where little hangs on it: as in contact_steps.h, but
// in one step, whatever strikes within it.
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// Moves a body that touches a plane by `time` seconds.
void move_on_planes_at_once(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                            const SupportSettings& settings, ContactTally& tally);

}  // namespace lodestone
