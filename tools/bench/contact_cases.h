// F7 to F9 and F19: trimeshes that meet, in stacks, in piles, in random poses, and hooked into each other.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

std::vector<HardCaseRow> measure_stacks(const HardCaseSettings& settings);          ///< F7
std::vector<HardCaseRow> measure_piles(const HardCaseSettings& settings);           ///< F8
std::vector<HardCaseRow> measure_contact_depths(const HardCaseSettings& settings);  ///< F9
std::vector<HardCaseRow> measure_concave(const HardCaseSettings& settings);         ///< F19

}  // namespace lodestone
