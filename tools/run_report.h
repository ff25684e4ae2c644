// What a run of a scene showed, as text for people and as JSON for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scenes/runner.h"
#include "tools/commands.h"

namespace lodestone {

std::string text_of(const RunResult& result);

/// A budget of work has `work` in place of `ms`, and `over` null.
nlohmann::ordered_json json_of(const BudgetFigures& budget);
/// Keys as tools/README.md lists them.
nlohmann::ordered_json json_of(const RunResult& result);

/// Diverged where a state was not finite, bad_input where a file could not be written, interrupted or
/// terminated where a signal ended the run, check_failed where one of the scene's checks does not hold.
ExitCode exit_code_of(const RunResult& result);

}  // namespace lodestone
