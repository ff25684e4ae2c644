#include "tools/bench/command_bench_endurance.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/bench/endurance_bench.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  EnduranceSettings bench;
  bool json = false;
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

ExitCode run_bench(Arguments arguments) {
  EnduranceFigures figures;
  {
    ProgressLine line;
    arguments.bench.progress = line.function();
    figures = bench_endurance(arguments.bench);
  }
  if (arguments.json)
    print_json(json_of(figures));
  else
    fmt::print("{}", text_of(figures));
  return endures(figures) ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace

void add_bench_endurance_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command =
      bench.add_subcommand("endurance", "a small world for millions of steps: memory, energy and pace");
  const auto arguments = std::make_shared<Arguments>();
  EnduranceSettings& settings = arguments->bench;
  command->add_option("--steps", settings.steps, "of 1/60 s")
      ->check(CLI::Range(std::int64_t(2 * kEnduranceRound), std::int64_t(10'000'000'000)))
      ->capture_default_str();
  command->add_option("--bodies", settings.bodies, "crates")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--threads", settings.threads, "of the statistical level")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--seed", settings.seed, "of the starts")->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->footer("Exit code 1 where a figure is beyond its bound.");
  command->callback([arguments, &exit_code] { exit_code = run_bench(*arguments); });
}

}  // namespace lodestone
