// A comparison of piles as a table for people, as JSON and as raw CSV for programs.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/compare/pile_comparison.h"

namespace lodestone {

/// What was dropped, then a table: the truth and the noise floor in its first rows, then each method at each
/// step; then what the columns are.
std::string text_of(const DropJob& job, const PileComparison& comparison);

/// Keys as tools/README.md lists them; what was left out is null.
nlohmann::ordered_json json_of(const PileComparison& comparison);

/// Writes DIR/piles.csv, one line for each pile, and DIR/pile_energy.csv, the mean kinetic energy of each
/// method's piles by time. Throws InputError where it cannot.
void save_piles(const PileComparison& comparison, const std::filesystem::path& folder);

}  // namespace lodestone
