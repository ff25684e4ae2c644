#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <iostream>

#include "reference/error.h"
#include "tools/commands.h"

namespace lodestone {
namespace {

constexpr const char* kExitCodes =
    "Results go to stdout, progress and errors to stderr.\n"
    "Exit codes: 0 done, 1 a check failed, 2 usage, 3 bad input, 4 the simulation diverged.";

// CLI11 prints help to stdout and errors to stderr; its own exit codes are not ours.
ExitCode explain(const CLI::App& program, const CLI::ParseError& error) {
  const bool asked_for = program.exit(error, std::cout, std::cerr) == 0;
  return asked_for ? ExitCode::done : ExitCode::usage;
}

}  // namespace

ExitCode run_lodestone(int argc, char** argv) {
  CLI::App program("Simulation level of detail for rigid bodies, on ODE", "lodestone");
  program.require_subcommand(1);
  program.footer(kExitCodes);
  ExitCode exit_code = ExitCode::done;
  for (const auto add : {add_run_command, add_view_command, add_replay_command, add_compare_command, add_sign_command, add_merge_command, add_inspect_command, add_demo_command, add_bench_command,
                         add_report_command})
    add(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return explain(program, error);
  } catch (const InputError& error) {
    fmt::print(stderr, "lodestone: {}\n", error.what());
    return ExitCode::bad_input;
  }
  return exit_code;
}

}  // namespace lodestone
