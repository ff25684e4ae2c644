// `lodestone bench endurance`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_endurance_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
