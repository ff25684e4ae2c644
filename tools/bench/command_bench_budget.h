// `lodestone bench budget`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_budget_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
