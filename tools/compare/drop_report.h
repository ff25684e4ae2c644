// A comparison of drops as a table for people, as JSON and as raw CSV for programs.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/compare/drop_comparison.h"

namespace lodestone {

/// What was dropped, then a table: the floor in its first row, then each method at each step; then what the
/// columns are.
std::string text_of(const DropJob& job, const DropComparison& comparison);

/// Keys as tools/README.md lists them; what is undefined is null.
nlohmann::ordered_json json_of(const DropComparison& comparison);

/// Its scores as flat rows: the noise floor first (method "noise_floor", at the truth's step), then each
/// method at each step.
nlohmann::ordered_json score_rows_of(const DropComparison& comparison);

/// These as a CSV file (tools/results.h). Throws InputError where it cannot be written.
void save_scores(const DropComparison& comparison, const std::filesystem::path& file);

/// Writes DIR/drops.csv, one line for each drop of each method and of both batches of truth. Throws
/// InputError where it cannot.
void save_drops(const DropComparison& comparison, const std::filesystem::path& folder);

}  // namespace lodestone
