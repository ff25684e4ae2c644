// What full bodies touch, by their hulls, where ODE has not said it: the caller's bodies, whose contacts he
// makes himself, and those that have just become full.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/ground/met_ground.h"
#include "lod/statistical/full_neighbor.h"

namespace lodestone {

/// Appends those of neighbour `index`, which is `body`, with the ground.
void reckon_ground_contacts(const MetGround& ground, const FullNeighbor& body, std::int32_t index,
                            std::vector<FullContact>& contacts);

/// Appends those of two neighbours, `bodies[first]` and `bodies[second]`.
void reckon_pair_contacts(std::span<const FullNeighbor> bodies, std::int32_t first, std::int32_t second,
                          std::vector<FullContact>& contacts);

}  // namespace lodestone
