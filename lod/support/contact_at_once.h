// How an angular hull slides and rocks on planes: by the leapfrog rule of contact_stepper.h, but in equal
// steps, whatever strikes within one bouncing at once. What rolls over small sides would lose too much energy
// by it; here nothing hangs on it, and it is cheaper.
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// Of planes that a body may touch at once.
inline constexpr int kMostPlanesAtOnce = 2;

/// Moves a body that touches a plane, and is near no more than kMostPlanesAtOnce of them, by `time` seconds,
/// in steps of at most SupportSettings::step_at_once.
void move_on_planes_at_once(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                            const SupportSettings& settings, ContactTally& tally);

}  // namespace lodestone
