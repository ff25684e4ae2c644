// A body's way onto, between and off the rungs: the one place that moves bodies.
//
// Pose and velocities are carried over to the bit, with sleep and the force that waits for the next step.
#pragma once

#include <span>

#include "lod/manager/levels.h"

namespace lodestone {

/// Has the signature that the body needs on a statistical rung, before anything is moved. Throws InputError
/// where the source has none that serves.
void find_signature(Levels& levels, std::uint32_t body, Rung rung);

/// Gives a rung to a body that has none yet.
void place(Levels& levels, std::uint32_t body, Rung rung);

/// Moves a body to another rung. Where it is awake it wakes what touches it; a sleeper goes on sleeping and
/// wakes nobody, for it is where it was.
void transfer(Levels& levels, std::uint32_t body, Rung to);

/// Takes a body off its rung and wakes what touched it.
void take_out(Levels& levels, std::uint32_t body);

/// Whether the hull of a body overlaps another body's hull or a plane of the ground so deep that ODE, given
/// the body, would throw it; `but` some bodies, that go with it.
bool overlaps(const Levels& levels, std::uint32_t body, std::span<const std::uint32_t> but = {});

}  // namespace lodestone
