// S7 to S9, S12, S13 and S15: single bodies of the statistical level, against ODE's or against what mechanics predicts.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// How high bodies rise after their first impact, by restitution and step, beside ODE's.
std::vector<HardCaseRow> measure_first_rebounds(const HardCaseSettings& settings);   ///< S7

/// Bodies at 200 m/s against a plane and against each other.
std::vector<HardCaseRow> measure_fast_hits(const HardCaseSettings& settings);        ///< S8

/// Slopes from 0 to 60 degrees: what slides and what is led to a rest pose.
std::vector<HardCaseRow> measure_rest_on_slopes(const HardCaseSettings& settings);   ///< S9

/// Ten million steps of free flight.
std::vector<HardCaseRow> measure_long_flight(const HardCaseSettings& settings);      ///< S12

/// The collision height of a square (the paper's figure 3).
std::vector<HardCaseRow> measure_square_heights(const HardCaseSettings& settings);   ///< S13

/// A box let down flat (the paper's 5.1), beside ODE's.
std::vector<HardCaseRow> measure_flat_landings(const HardCaseSettings& settings);    ///< S15

}  // namespace lodestone
