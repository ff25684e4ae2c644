// `lodestone compare errors SHAPE`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_compare_errors_command(CLI::App& compare, ExitCode& exit_code);

}  // namespace lodestone
