// `lodestone bench churn`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_churn_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
