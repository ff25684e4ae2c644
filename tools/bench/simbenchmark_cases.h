// F1–F4: the tasks of SimBenchmark (leggedrobotics, 2018) that are about spheres and boxes, with the figures published there for ODE.
// Those were made without error reduction and constraint force mixing, and so are these.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// 7 × 7 elastic balls bounce for 20 s: the mean squared error of their energy.
std::vector<HardCaseRow> measure_bouncing(const HardCaseSettings& settings);

}  // namespace lodestone
