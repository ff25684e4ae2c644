// F1–F4: the tasks of SimBenchmark (leggedrobotics, 2018) that are about spheres and boxes, with the figures published there for ODE.
// Those were made without error reduction and constraint force mixing, and so are these.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// 7 × 7 elastic balls bounce for 20 s: the mean squared error of their energy.
std::vector<HardCaseRow> measure_bouncing(const HardCaseSettings& settings);

/// "666": a cube of 6^3 balls collapses without friction or restitution: the mean sum of squared penetrations.
std::vector<HardCaseRow> measure_ball_cube(const HardCaseSettings& settings);

/// The same, elastic, from a metre higher: the mean squared error of the energy.
std::vector<HardCaseRow> measure_elastic_ball_cube(const HardCaseSettings& settings);

/// A box dragged over the ground makes 25 balls on top of it roll: the mean squared error of their velocities.
std::vector<HardCaseRow> measure_rolling(const HardCaseSettings& settings);

}  // namespace lodestone
