// `lodestone bench table1`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_table1_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
