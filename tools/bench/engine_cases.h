// F15–F17: what the whole engine does with places, steps and durations that ODE alone would not survive.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// Scenes with coordinates beyond 1e8 m or infinite; bodies that fly there.
std::vector<HardCaseRow> measure_far_coordinates(const HardCaseSettings& settings);

/// A sleeping pile, stepped ten million times: its state and the process's memory.
std::vector<HardCaseRow> measure_sleeping_pile(const HardCaseSettings& settings);

/// Steps of 1e-5 and 1/10 s, zero, negative and no number at all.
std::vector<HardCaseRow> measure_step_lengths(const HardCaseSettings& settings);

}  // namespace lodestone
