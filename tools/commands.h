// The commands of `lodestone`, each a file of that name in commands/.
#pragma once

#include "tools/command.h"

namespace lodestone {

void add_run_command(Command& program);
void add_view_command(Command& program);
void add_replay_command(Command& program);
void add_sign_command(Command& program);
void add_merge_command(Command& program);
void add_inspect_command(Command& program);
void add_demo_command(Command& program);
void add_report_command(Command& program);

void add_compare_drop_command(Command& compare);
void add_compare_pile_command(Command& compare);
void add_compare_return_command(Command& compare);
void add_compare_errors_command(Command& compare);
void add_compare_shapes_command(Command& compare);
void add_compare_conditions_command(Command& compare);
void add_compare_materials_command(Command& compare);
void add_compare_scores_command(Command& compare);

void add_bench_hard_cases_command(Command& bench);
void add_bench_full_level_command(Command& bench);
void add_bench_table1_command(Command& bench);
void add_bench_drops_command(Command& bench);
void add_bench_broad_phase_command(Command& bench);
void add_bench_settled_command(Command& bench);
void add_bench_budget_command(Command& bench);
void add_bench_rungs_command(Command& bench);
void add_bench_transitions_command(Command& bench);
void add_bench_attached_command(Command& bench);
void add_bench_churn_command(Command& bench);
void add_bench_endurance_command(Command& bench);

/// All of them, in the order in which --help lists them.
void add_commands(Command& program);

/// The whole program: parses the arguments, runs one command and says on stderr what went wrong.
ExitCode run_lodestone(int argc, char** argv);

}  // namespace lodestone
