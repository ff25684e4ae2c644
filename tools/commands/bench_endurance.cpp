#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "scenes/scene_file.h"
#include "tools/bench/endurance_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchEnduranceArguments {
  EnduranceSettings bench;
  std::string scene;
  ResultArguments results;
};

ordered_json json_of(const EnduranceFigures& f) {
  return {{"steps", f.steps},
          {"changes", f.changes},
          {"states_recovered", f.states_recovered},
          {"heap_growth_bytes", f.heap_growth_bytes},
          {"resident_growth_bytes", f.resident_growth_bytes},
          {"energy_over_start", f.energy_over_start},
          {"first_step_us", f.first_step_us},
          {"last_step_us", f.last_step_us},
          {"finite", f.finite},
          {"endures", endures(f)}};
}

std::string text_of(const EnduranceFigures& f) {
  TextTable table({"", "figure", "bound"});
  table.add_row({"heap, growth kB", fmt::format("{:.1f}", f.heap_growth_bytes / 1024),
                 fmt::format("{:.0f}", kEnduranceMemory / 1024)});
  table.add_row({"resident, growth kB", fmt::format("{:.1f}", f.resident_growth_bytes / 1024),
                 fmt::format("{:.0f}", kEnduranceMemory / 1024)});
  table.add_row({"energy over the start", fmt::format("{:.6f}", f.energy_over_start),
                 fmt::format("{}", kEnduranceEnergy)});
  table.add_row({"last step over first",
                 fmt::format("{:.2f} us / {:.2f} us", f.last_step_us, f.first_step_us),
                 fmt::format("{}", kEnduranceSlower)});
  table.add_row({"states recovered", fmt::format("{}", f.states_recovered), "0"});
  return fmt::format("{} steps of 1/60 s, {} changes of rung\n\n{}\n{}\n", f.steps, f.changes, table.text(),
                     endures(f) ? "holds" : "FAILED");
}

ExitCode run_endurance(BenchEnduranceArguments arguments) {
  if (!arguments.scene.empty()) arguments.bench.scene = load_scene(arguments.scene);
  const EnduranceFigures figures = with_progress(arguments.bench, bench_endurance);
  print_results(arguments.results, json_of(figures), text_of(figures));
  return endures(figures) ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_endurance_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchEnduranceArguments>(
      "endurance", "a small world for millions of steps: memory, energy and pace", run_endurance);
  EnduranceSettings& settings = arguments.bench;
  command.add_option("--steps", settings.steps, "of 1/60 s")
      .within(std::int64_t(2 * kEnduranceRound), std::int64_t(10'000'000'000));
  const Option scene = command.add_option("--scene", arguments.scene,
                                          "a YAML file, instead of crates: a viewpoint circles it");
  command.add_option("--bodies", settings.bodies, "crates").within(1, 1000).excludes(scene);
  command.add_option("--threads", settings.threads, "of the statistical level").within(1, 4096);
  command.add_option("--seed", settings.seed, "of the crates' starts").excludes(scene);
  add_json_argument(command, arguments.results);
  command.add_footer("Exit code 1 where a figure is beyond its bound.");
}

}  // namespace lodestone
