#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/hard_cases/hard_case_report.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct BenchHardCasesArguments {
  HardCaseRunSettings running;
  ResultArguments results;
};

std::vector<std::string> ids() {
  std::vector<std::string> ids;
  for (const HardCase& one : hard_cases()) ids.emplace_back(one.id);
  return ids;
}

ExitCode bench_hard_cases(const BenchHardCasesArguments& arguments) {
  const std::vector<HardCaseResult> results = with_progress(arguments.running, run_hard_cases);
  print_results(arguments.results, json_of(results), text_of(results));
  if (!arguments.results.csv.empty()) save_csv(results, arguments.results.csv);
  return exit_code_of(results);
}

}  // namespace

void add_bench_hard_cases_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchHardCasesArguments>(
      "hard_cases", "set-ups on which engines are known to fail, each figure beside its bound",
      bench_hard_cases);
  command.add_option("--only", arguments.running.only, "some of the cases, with commas")
      .several()
      .one_of(ids());
  command.add_option("--threads", arguments.running.threads, "0: all cores").within(0, 4096);
  command.add_flag("--quick", arguments.running.cases.quick, "shorten the long ones");
  add_table_arguments(command, arguments.results, "file for the table, one line a figure");
  command.add_footer("Exit code 1 where a figure fails for another reason than ODE's own.");
}

}  // namespace lodestone
