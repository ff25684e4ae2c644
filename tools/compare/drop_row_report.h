// The rows of a comparison of drops, as cells of a table for people and as JSON for programs: the same
// wherever drops are compared.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/compare/drop_comparison.h"

namespace lodestone {

/// What the cells of a row are, and in words for the foot of a table.
std::vector<std::string> drop_row_heading();
std::string drop_row_footer();

/// The noise floor as the row above the methods'.
std::vector<std::string> cells_of_floor(const ScoreWithInterval& floor);
/// A method at a step; short where it was left out.
std::vector<std::string> cells_of(const DropRow& row);

/// Adds `parts` and the score's parts; what is undefined is null.
void add_parts(nlohmann::ordered_json& json, const DropScore& score);
nlohmann::ordered_json json_of(const DropRow& row, const ScoreWithInterval& floor);

}  // namespace lodestone
