// F7 to F9: trimeshes that meet, in stacks, in piles and in random poses.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

std::vector<HardCaseRow> measure_stacks(const HardCaseSettings& settings);          ///< F7
std::vector<HardCaseRow> measure_piles(const HardCaseSettings& settings);           ///< F8
std::vector<HardCaseRow> measure_contact_depths(const HardCaseSettings& settings);  ///< F9

}  // namespace lodestone
