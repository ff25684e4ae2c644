// `lodestone bench rungs`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_rungs_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
