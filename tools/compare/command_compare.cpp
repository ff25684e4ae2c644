#include <CLI/CLI.hpp>

#include "tools/commands.h"
#include "tools/compare/command_compare_drop.h"
#include "tools/compare/command_compare_errors.h"
#include "tools/compare/command_compare_pile.h"
#include "tools/compare/command_compare_return.h"
#include "tools/compare/command_compare_series.h"
#include "tools/interrupt.h"

namespace lodestone {

void add_compare_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* compare = program.add_subcommand("compare", "error against the truth, beside cost");
  compare->require_subcommand(1);
  compare->preparse_callback([](std::size_t) { catch_interrupts(); });
  add_compare_drop_command(*compare, exit_code);
  add_compare_pile_command(*compare, exit_code);
  add_compare_return_command(*compare, exit_code);
  add_compare_errors_command(*compare, exit_code);
  add_compare_shapes_command(*compare, exit_code);
  add_compare_conditions_command(*compare, exit_code);
}

}  // namespace lodestone
