// S10, S11, S14 and S16: many bodies of the statistical level, in crowds or one by one.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// Ten thousand boxes fall into a heap and lie for a minute.
std::vector<HardCaseRow> measure_great_pile(const HardCaseSettings& settings);        ///< S10

/// How often drops end in each rest pose, beside ODE's.
std::vector<HardCaseRow> measure_rest_poses_of_drops(const HardCaseSettings& settings);  ///< S11

/// The same bodies in another order, and on other numbers of threads.
std::vector<HardCaseRow> measure_orders(const HardCaseSettings& settings);            ///< S14

/// L-shapes that collide in the air: how many stand still there (the paper's 5.2), beside ODE's.
std::vector<HardCaseRow> measure_frozen_in_air(const HardCaseSettings& settings);     ///< S16

}  // namespace lodestone
