#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/broad_phase_report.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct BenchBroadPhaseArguments {
  BroadPhaseSettings bench;
  ResultArguments results;
};

std::vector<std::string> layout_names() {
  std::vector<std::string> names;
  for (const BallLayout& layout : ball_layouts()) names.emplace_back(layout.name);
  return names;
}

// What is measured, and how the balls lie.
std::string text_of(const BroadPhaseSettings& bench) {
  std::string text = fmt::format(
      "the pairs of balls that meet, found anew in each step: ns a body, medians of {} steps of 1/60 s at "
      "{} m/s\n",
      bench.steps, bench.speed);
  for (const std::string& name : bench.layouts)
    text += fmt::format("  {}: {}\n", name, std::ranges::find(ball_layouts(), name, &BallLayout::name)->what);
  return text;
}

ExitCode run_broad_phase(const BenchBroadPhaseArguments& arguments) {
  const std::vector<BroadPhaseRow> rows = with_progress(arguments.bench, bench_broad_phase);
  print_table(arguments.results, json_of(rows), json_of(BroadPhaseRow{}),
              text_of(arguments.bench) + '\n' + text_of(rows));
  const bool right = std::ranges::all_of(rows, [](const BroadPhaseRow& row) { return row.fault.empty(); });
  return right ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_broad_phase_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchBroadPhaseArguments>(
      "broad_phase",
      "which balls are near each other: the statistical level's cells beside ODE's spaces and Bullet's tree",
      run_broad_phase);
  BroadPhaseSettings& settings = arguments.bench;
  command.add_option("--bodies", settings.bodies, "several with commas").several().within(2, 2'000'000);
  command.add_option("--layouts", settings.layouts, "how the balls lie").several().one_of(layout_names());
  command.add_option("--threads", settings.threads, "of the cells; the others run on one").within(1, 4096);
  command.add_option("--steps", settings.steps, "of 1/60 s").within(1, 10'000);
  command.add_option("--speed", settings.speed, "of every ball, m/s").within(0.0, 1e3);
  command
      .add_option("--row-seconds", settings.row_seconds, "leave out an alternative that would take longer, s")
      .within(0.0, 1e9);
  command.add_option("--seed", settings.seed, "of the layouts");
  add_table_arguments(command, arguments.results);
  command.add_footer(
      "Exit code 1 where the cells missed a pair that another method found, or found one twice.");
}

}  // namespace lodestone
