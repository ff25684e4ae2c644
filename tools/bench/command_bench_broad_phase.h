// `lodestone bench broad_phase`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_broad_phase_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
