// `lodestone bench hard_cases`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/hard_cases/hard_case_report.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct Arguments {
  HardCaseRunSettings running;
  std::filesystem::path csv;
  bool json = false;
};

std::vector<std::string> ids() {
  std::vector<std::string> ids;
  for (const HardCase& one : hard_cases()) ids.emplace_back(one.id);
  return ids;
}

ExitCode bench_hard_cases(const Arguments& arguments) {
  std::vector<HardCaseResult> results;
  {
    ProgressLine line;
    HardCaseRunSettings settings = arguments.running;
    settings.progress = line.function();
    results = run_hard_cases(settings);
  }
  if (!arguments.csv.empty()) save_csv(results, arguments.csv);
  if (arguments.json)
    print_json(json_of(results));
  else
    fmt::print("{}", text_of(results));
  return exit_code_of(results);
}

}  // namespace

void add_bench_hard_cases_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "hard_cases", "set-ups on which engines are known to fail, each figure beside its bound");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("--only", arguments->running.only, "some of the cases, with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(ids()));
  command->add_option("--threads", arguments->running.threads, "0: all cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_flag("--quick", arguments->running.cases.quick, "shorten the long ones");
  command->add_option("--csv", arguments->csv, "file for the table, one line a figure");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->footer("Exit code 1 where a figure fails for another reason than ODE's own.");
  command->callback([arguments, &exit_code] { exit_code = bench_hard_cases(*arguments); });
}

}  // namespace lodestone
