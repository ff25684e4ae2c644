// Hard cases as a table for people and as JSON for programs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/hard_cases/hard_case_run.h"

namespace lodestone {

/// One line for each figure, then how many keep their bound and why the others do not.
std::string text_of(std::span<const HardCaseResult> results);

/// Keys as tools/README.md lists them.
nlohmann::ordered_json json_of(std::span<const HardCaseResult> results);

/// One line for each figure, with the keys of the JSON. Throws InputError where the file cannot be written.
void save_csv(std::span<const HardCaseResult> results, const std::filesystem::path& file);

/// check_failed where a figure fails that ODE is not to blame for.
ExitCode exit_code_of(std::span<const HardCaseResult> results);

}  // namespace lodestone
