// `lodestone bench settled`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_settled_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
