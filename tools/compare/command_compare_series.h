// `lodestone compare shapes` and `lodestone compare conditions SHAPE`.
#pragma once

#include "tools/commands.h"

namespace lodestone {

void add_compare_shapes_command(CLI::App& compare, ExitCode& exit_code);
void add_compare_conditions_command(CLI::App& compare, ExitCode& exit_code);

}  // namespace lodestone
