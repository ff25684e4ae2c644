// `lodestone bench hard_cases`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_hard_cases_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
