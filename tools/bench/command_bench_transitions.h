// `lodestone bench transitions`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_transitions_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
