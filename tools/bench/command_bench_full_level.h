// `lodestone bench full_level`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_full_level_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
