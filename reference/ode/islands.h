// How large a problem dWorldStep would have to solve at once: bodies that touch, directly or through others,
// are one island.
#pragma once

#include <span>

#include "reference/ode/ode_world.h"

namespace lodestone {

/// The number of contacts of the island that has most.
int largest_island(std::span<const OdeContact> contacts);

}  // namespace lodestone
