#include "tools/bench/command_bench_table1.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/bench/table1_report.h"
#include "tools/compare/method_argument.h"
#include "tools/progress.h"
#include "tools/results.h"

namespace lodestone {
namespace {

struct Arguments {
  Table1Settings table;
  std::filesystem::path csv;
  bool roofline = false, json = false;
};

void bench_table1(Arguments arguments) {
  std::vector<Table1Row> rows;
  {
    ProgressLine line;
    arguments.table.progress = line.function();
    rows = measure_table1(arguments.table);
  }
  std::optional<Bandwidth> bandwidth;
  if (arguments.roofline) compare_with(bandwidth.emplace(measure_bandwidth(arguments.table.threads)), rows);
  if (!arguments.csv.empty()) save_csv(rows, arguments.csv);
  if (arguments.json) {
    auto json = json_of(rows);
    if (bandwidth) json["bandwidth"] = json_of(*bandwidth);
    print_json(json);
  } else {
    fmt::print(
        "bunnies of .2 m and 4,698 faces, restitution .3, friction .5, {} steps of 1/60 s, sleep {}: medians "
        "of a step from the {}th on, ms\n\n{}",
        kTable1Steps, arguments.table.sleeping ? "on" : "off", kTable1FirstTimed, text_of(rows));
    if (bandwidth) fmt::print("\n{}", roofline_text_of(*bandwidth, rows));
  }
}

}  // namespace

void add_bench_table1_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "table1", "the paper's table 1: what a step of n fallen bunnies costs by each method");
  const auto arguments = std::make_shared<Arguments>();
  Table1Settings& table = arguments->table;
  command->add_option("--bodies", table.bodies, "several with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(1, 2'000'000))
      ->capture_default_str();
  command
      ->add_option("--methods", table.methods,
                   "of compare drop; the statistical level with both of its models")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(find_method_fault, "METHODS")
      ->capture_default_str();
  command->add_option("--model", table.model, "of the statistical level: this one only")
      ->check(CLI::IsMember({"tables", "tables_on_hull", "support"}));
  command->add_option("--threads", table.threads, "of the statistical level")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_flag("--sleep", table.sleeping, "bodies at rest may sleep, by every method");
  command->add_option("--row-seconds", table.row_seconds, "leave out rows that would take longer, s")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  command->add_option("--seed", table.seed, "of the starts")->capture_default_str();
  command->add_option("--csv", arguments->csv, "file for the table, one line a row");
  command->add_flag("--roofline", arguments->roofline,
                    "what rows of `tables` move in memory, beside what the machine can");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    bench_table1(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
