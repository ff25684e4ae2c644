// `lodestone compare return SHAPE`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_compare_return_command(CLI::App& compare, ExitCode& exit_code);

}  // namespace lodestone
