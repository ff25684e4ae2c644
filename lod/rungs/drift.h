// The velocity that most of what moves has in common, such as that of all that has fallen off the world. The
// broad phase looks from a frame that goes with it: bodies that fall side by side at 100 m/s are not near
// each other for that.
#pragma once

#include <span>

#include "lod/statistical/full_neighbor.h"
#include "lod/support/support_level.h"
#include "lod/tables/tables_level.h"

namespace lodestone {

/// m/s; zero where bodies go less far than their size in a step of `dt` seconds, or each its own way. Any
/// velocity would do; a poor one costs time.
Vec3 find_drift(double dt, const TablesLevel& tables, const SupportLevel& support,
                std::span<const FullNeighbor> neighbors);

}  // namespace lodestone
