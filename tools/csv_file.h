// Rows of JSON as a CSV file.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace lodestone {

/// A line of the keys of `example`, and one for each of `rows`: null is an empty cell, the numbers of an
/// array stand in one, with spaces. Throws InputError where the file cannot be written.
void save_csv(const nlohmann::ordered_json& rows, const nlohmann::ordered_json& example,
              const std::filesystem::path& file);

}  // namespace lodestone
