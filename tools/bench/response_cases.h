// S1 to S6: what the statistical level makes of single collisions, the odd ones and very many.
#pragma once

#include "tools/bench/hard_case.h"

namespace lodestone {

/// Collisions of bodies that do not move, or do not spin.
std::vector<HardCaseRow> measure_motionless_hits(const HardCaseSettings& settings);  ///< S1

/// The working frame where velocity and normal are all but parallel.
std::vector<HardCaseRow> measure_contact_frames(const HardCaseSettings& settings);   ///< S2

/// Spin along the velocity; bodies in contact that move apart.
std::vector<HardCaseRow> measure_odd_directions(const HardCaseSettings& settings);   ///< S3

/// What lies beyond the tables, and what is no number.
std::vector<HardCaseRow> measure_beyond_tables(const HardCaseSettings& settings);    ///< S4

/// Hits over the whole table: energy, direction and, after truncation, the measured moments.
std::vector<HardCaseRow> measure_random_hits(const HardCaseSettings& settings);      ///< S5

/// Draws from cells against the cells' moments.
std::vector<HardCaseRow> measure_draws(const HardCaseSettings& settings);            ///< S6

}  // namespace lodestone
