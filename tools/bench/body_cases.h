// F5, F6, F11, F12, F18: one body or two against what mechanics predicts.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// A box on a slope, whichever way that faces: its speed after 2 s, by Coulomb's law.
std::vector<HardCaseRow> measure_slopes(const HardCaseSettings& settings);

/// A ball dropped from twenty heights: how high it rises again.
std::vector<HardCaseRow> measure_rebounds(const HardCaseSettings& settings);

/// A box that spins freely near its middle axis: energy and angular momentum.
std::vector<HardCaseRow> measure_free_top(const HardCaseSettings& settings);

/// Needles and laths that fall; an inertia that no body has.
std::vector<HardCaseRow> measure_slender_bodies(const HardCaseSettings& settings);

/// Two bodies that meet head-on without gravity or loss: momentum and energy.
std::vector<HardCaseRow> measure_head_on(const HardCaseSettings& settings);

}  // namespace lodestone
