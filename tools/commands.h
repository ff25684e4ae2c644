// The subcommands of `lodestone`. Each adds its options to the program and, once chosen, runs when the
// arguments are parsed.
#pragma once

namespace CLI {
class App;
}

namespace lodestone {

/// What scripts can rely on. `usage`: the command line is wrong, a name or a value in it. `bad_input`: what
/// it names cannot be used: a shape, or a file that cannot be read, is wrong, or cannot be written (standard
/// output among them).
enum class ExitCode {
  done = 0,
  check_failed = 1,
  usage = 2,
  bad_input = 3,
  diverged = 4,
  interrupted = 130,
  terminated = 143
};

/// `exit_code` receives how the chosen command ended; it outlives the program's parsing. InputError passes
/// through.
void add_run_command(CLI::App& program, ExitCode& exit_code);
void add_view_command(CLI::App& program, ExitCode& exit_code);
void add_replay_command(CLI::App& program, ExitCode& exit_code);
void add_sign_command(CLI::App& program, ExitCode& exit_code);
void add_merge_command(CLI::App& program, ExitCode& exit_code);
void add_inspect_command(CLI::App& program, ExitCode& exit_code);
void add_compare_command(CLI::App& program, ExitCode& exit_code);
void add_demo_command(CLI::App& program, ExitCode& exit_code);
void add_bench_command(CLI::App& program, ExitCode& exit_code);
void add_report_command(CLI::App& program, ExitCode& exit_code);

/// The whole program: parses the arguments, runs one command and says on stderr what went wrong.
ExitCode run_lodestone(int argc, char** argv);

}  // namespace lodestone
