// A body's way into, between and out of the levels: the one place that moves bodies.
//
// Pose and velocities are carried over to the bit, with sleep and the force that waits for the next step.
#pragma once

#include "lod/levels.h"

namespace lodestone {

/// Gives a level to a body that has none yet.
void place(Levels& levels, std::uint32_t body, Level level);

/// Moves a body to the other level and wakes what touched it.
void transfer(Levels& levels, std::uint32_t body);

/// Takes a body out of its level and wakes what touched it.
void take_out(Levels& levels, std::uint32_t body);

/// Whether the hull of a body overlaps another body's hull or a plane of the ground so deep that ODE, given the body, would throw it.
bool overlaps(const Levels& levels, std::uint32_t body);

}  // namespace lodestone
