// F10, F13, F14: stacks and fast bodies, on which ODE's solver, its step or its arithmetic give out.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// A heavy cube on a light one: how far it sinks in.
std::vector<HardCaseRow> measure_heavy_on_light(const HardCaseSettings& settings);

/// Bodies at 200 m/s against thin walls and each other: how many come out on the other side.
std::vector<HardCaseRow> measure_fast_bodies(const HardCaseSettings& settings);

/// A stack far from the origin, against the same at the origin.
std::vector<HardCaseRow> measure_far_stacks(const HardCaseSettings& settings);

}  // namespace lodestone
