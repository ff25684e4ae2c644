// Where an error budget is spent: on the rungs that lessen the error in the picture most for what they cost,
// body by body. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/manager/share_of_full.h"

namespace lodestone {

/// Above what all cost on their lowest rungs, in the unit of the budget: for those that are on a higher rung,
/// and for more of them.
struct ErrorRoom {
  double keep = 0.0, grow = 0.0;
};

struct ErrorShareLimits {
  std::int64_t most_full = 0, most_support = 0;
  double hysteresis = 0.0;
};

/// The rung of each candidate that the policy has a say in; the lowest of the others. Greedy: of all steps up
/// the one that saves most error per cost, as long as it fits. Where a body's way to full saves more per cost
/// than its way to `support`, it is one step. `bill` has those that must be full.
std::vector<Rung> share_by_error(std::span<const LevelCandidate> candidates, FullBill bill,
                                 const ErrorRoom& room, const ErrorShareLimits& limits);

}  // namespace lodestone
