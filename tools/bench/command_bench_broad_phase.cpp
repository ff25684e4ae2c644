#include "tools/bench/command_bench_broad_phase.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/bench/broad_phase_report.h"
#include "tools/csv_file.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct Arguments {
  BroadPhaseSettings bench;
  std::filesystem::path csv;
  bool json = false;
};

std::vector<std::string> layout_names() {
  std::vector<std::string> names;
  for (const BallLayout& layout : ball_layouts()) names.emplace_back(layout.name);
  return names;
}

ExitCode run_bench(Arguments arguments) {
  std::vector<BroadPhaseRow> rows;
  {
    ProgressLine line;
    arguments.bench.progress = line.function();
    rows = bench_broad_phase(arguments.bench);
  }
  if (!arguments.csv.empty()) save_csv(json_of(rows)["rows"], json_of(BroadPhaseRow{}), arguments.csv);
  if (arguments.json) {
    print_json(json_of(rows));
  } else {
    fmt::print(
        "the pairs of balls that meet, found anew in each step: ns a body, medians of {} steps of 1/60 s at "
        "{} m/s\n",
        arguments.bench.steps, arguments.bench.speed);
    for (const std::string& name : arguments.bench.layouts)
      fmt::print("  {}: {}\n", name, std::ranges::find(ball_layouts(), name, &BallLayout::name)->what);
    fmt::print("\n{}", text_of(rows));
  }
  const bool right = std::ranges::all_of(rows, [](const BroadPhaseRow& row) { return row.fault.empty(); });
  return right ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_broad_phase_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "broad_phase",
      "which balls are near each other: the statistical level's cells beside ODE's spaces and Bullet's tree");
  const auto arguments = std::make_shared<Arguments>();
  BroadPhaseSettings& settings = arguments->bench;
  command->add_option("--bodies", settings.bodies, "several with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(2, 2'000'000))
      ->capture_default_str();
  command->add_option("--layouts", settings.layouts, "how the balls lie")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(layout_names()))
      ->capture_default_str();
  command->add_option("--threads", settings.threads, "of the cells; the others run on one")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--steps", settings.steps, "of 1/60 s")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--speed", settings.speed, "of every ball, m/s")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  command
      ->add_option("--row-seconds", settings.row_seconds,
                   "leave out an alternative that would take longer, s")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  command->add_option("--seed", settings.seed, "of the layouts")->capture_default_str();
  command->add_option("--csv", arguments->csv, "file for the table, one line a row");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->footer("Exit code 1 where the cells missed a pair that another method found, or found one twice.");
  command->callback([arguments, &exit_code] { exit_code = run_bench(*arguments); });
}

}  // namespace lodestone
