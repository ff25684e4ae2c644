#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/table1_report.h"
#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct BenchTable1Arguments {
  Table1Settings table;
  bool roofline = false;
  ResultArguments results;
};

void run_table1(const BenchTable1Arguments& arguments) {
  const Table1Settings& table = arguments.table;
  std::vector<Table1Row> rows = with_progress(table, measure_table1);
  std::string text = fmt::format(
      "bunnies of .2 m and 4,698 faces, restitution .3, friction .5, {} steps of 1/60 s, sleep {}: medians "
      "of a step from the {}th on, ms\n\n",
      kTable1Steps, table.sleeping ? "on" : "off", kTable1FirstTimed);
  std::optional<nlohmann::ordered_json> bandwidth;
  std::string roofline;
  if (arguments.roofline) {
    const Bandwidth measured = measure_bandwidth(table.threads);
    compare_with(measured, rows);
    bandwidth = json_of(measured);
    roofline = '\n' + roofline_text_of(measured, rows);
  }
  nlohmann::ordered_json json = json_of(rows);
  if (bandwidth) json["bandwidth"] = *bandwidth;
  print_table(arguments.results, json, json_of(Table1Row{}), text + text_of(rows) + roofline);
}

}  // namespace

void add_bench_table1_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchTable1Arguments>(
      "table1", "the paper's table 1: what a step of n fallen bunnies costs by each method", run_table1);
  Table1Settings& table = arguments.table;
  command.add_option("--bodies", table.bodies, "several with commas").several().within(1, 2'000'000);
  add_methods_argument(command, table.methods,
                       "of compare drop; the statistical level with all of its models");
  add_model_argument(command, table.model);
  command.add_option("--threads", table.threads, "of the statistical level").within(1, 4096);
  command.add_flag("--sleep", table.sleeping, "bodies at rest may sleep, by every method");
  command.add_option("--row-seconds", table.row_seconds, "leave out rows that would take longer, s")
      .within(0.0, 1e9);
  command.add_option("--seed", table.seed, "of the starts");
  command.add_flag("--roofline", arguments.roofline,
                   "what rows of `tables` move in memory, beside what the machine can");
  add_table_arguments(command, arguments.results);
}

}  // namespace lodestone
