// `lodestone bench attached`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_bench_attached_command(CLI::App& bench, ExitCode& exit_code);

}  // namespace lodestone
