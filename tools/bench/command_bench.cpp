#include <CLI/CLI.hpp>

#include "tools/bench/command_bench_attached.h"
#include "tools/bench/command_bench_broad_phase.h"
#include "tools/bench/command_bench_budget.h"
#include "tools/bench/command_bench_churn.h"
#include "tools/bench/command_bench_endurance.h"
#include "tools/bench/command_bench_full_level.h"
#include "tools/bench/command_bench_rungs.h"
#include "tools/bench/command_bench_settled.h"
#include "tools/bench/command_bench_table1.h"
#include "tools/bench/command_bench_transitions.h"
#include "tools/hard_cases/hard_case_report.h"
#include "tools/interrupt.h"

namespace lodestone {

void add_bench_command(CLI::App& program, ExitCode& exit_code) {
  CLI::App* bench = program.add_subcommand("bench", "what the engine withstands, and what it costs");
  bench->require_subcommand(1);
  bench->preparse_callback([](std::size_t) { catch_interrupts(); });
  add_bench_hard_cases_command(*bench, exit_code);
  add_bench_full_level_command(*bench, exit_code);
  add_bench_table1_command(*bench, exit_code);
  add_bench_broad_phase_command(*bench, exit_code);
  add_bench_settled_command(*bench, exit_code);
  add_bench_budget_command(*bench, exit_code);
  add_bench_rungs_command(*bench, exit_code);
  add_bench_transitions_command(*bench, exit_code);
  add_bench_attached_command(*bench, exit_code);
  add_bench_churn_command(*bench, exit_code);
  add_bench_endurance_command(*bench, exit_code);
}

}  // namespace lodestone
