// The `support` model: the hull's exact support height and contact point, one closed-form frictional impulse
// per impact at its exact time, and a small multi-contact solver while the body slides, rolls or rocks. It
// takes the place of the sphere and the response tables of section 3.3; resting follows in settling clips
// (clip_player.h).
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// Moves a body that touches no other by `time` seconds over the ground's planes. `turned`: how it is turned
/// after them if it flies so long, where that is known (TurnLanes).
ContactTally step_support_body(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                               double time, const SupportSettings& settings, const Quat* turned = nullptr);

}  // namespace lodestone
