// Contacts between a full and a statistical body. The statistical level solves them, with the full bodies as they are at the start of the
// step; what they get from it is handed to ODE's bodies before the full level's step, so that momentum is kept to rounding.
#pragma once

#include <vector>

#include "lod/levels.h"

namespace lodestone {

/// The full bodies as the statistical level meets them, in the order of the full level's members.
void gather_neighbors(const Levels& levels, std::vector<FullNeighbor>& neighbors);

/// Gives each full body the impulses that came back, for a step of `dt` seconds.
void hand_over(Levels& levels, std::span<const FullNeighbor> neighbors, double dt);

}  // namespace lodestone
