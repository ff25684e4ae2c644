#include "tools/bench/command_bench_settled.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/bench/settled_bench.h"
#include "tools/csv_file.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  SettledSettings bench;
  std::string model;
  std::filesystem::path csv;
  bool json = false;
};

std::string name_of(StatisticalModel model) {
  return model == StatisticalModel::tables ? "tables" : "support";
}

std::string text_of(const std::vector<SettledRow>& rows) {
  TextTable table({"model", "bodies", "settled us", "viewpoint us", "moving us", "awake", "woken", "within m",
                   "beyond", "for steps", "median us", "most us", "bytes/body"});
  for (const SettledRow& row : rows)
    table.add_row({name_of(row.model), fmt::format("{}", row.bodies), fmt::format("{:.1f}", row.settled_us),
                   fmt::format("{:.1f}", row.watched_us), fmt::format("{:.1f}", row.moving_us),
                   fmt::format("{}", row.awake), fmt::format("{}", row.woken),
                   fmt::format("{:.2f}", row.farthest_woken_m), fmt::format("{}", row.woken_unseen),
                   fmt::format("{}", row.disturbed_steps), fmt::format("{:.1f}", row.disturbed_us),
                   fmt::format("{:.1f}", row.disturbed_most_us), fmt::format("{:.0f}", row.bytes_per_body)});
  return table.text();
}

ordered_json json_of(const SettledRow& row) {
  return {{"model", name_of(row.model)},
          {"bodies", row.bodies},
          {"threads", row.threads},
          {"settling_steps", row.settling_steps},
          {"awake", row.awake},
          {"bytes_per_body", row.bytes_per_body},
          {"settled_us", row.settled_us},
          {"viewpoint_us", row.watched_us},
          {"moving_viewpoint_us", row.moving_us},
          {"woken", row.woken},
          {"farthest_woken_m", row.farthest_woken_m},
          {"woken_beyond", row.woken_unseen},
          {"disturbed_steps", row.disturbed_steps},
          {"disturbed_us", row.disturbed_us},
          {"disturbed_most_us", row.disturbed_most_us}};
}

void run_bench(Arguments arguments) {
  if (!arguments.model.empty())
    arguments.bench.models = {arguments.model == "tables" ? StatisticalModel::tables
                                                          : StatisticalModel::support};
  std::vector<SettledRow> rows;
  {
    ProgressLine line;
    arguments.bench.progress = line.function();
    rows = bench_settled(arguments.bench);
  }
  ordered_json json = {{"rows", ordered_json::array()}};
  for (const SettledRow& row : rows) json["rows"].push_back(json_of(row));
  if (!arguments.csv.empty()) save_csv(json["rows"], json_of(SettledRow{}), arguments.csv);
  if (arguments.json)
    print_json(json);
  else
    fmt::print(
        "crates that sleep, half a metre apart: medians of a whole step of 1/60 s, in us: without "
        "viewpoints, with one, with one that moves;\n"
        "then one more falls in at {} m/s: how many are awake at once, how far from it, beyond what was "
        "looked at, and what those steps cost\n\n{}",
        arguments.bench.speed, text_of(rows));
}

}  // namespace

void add_bench_settled_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "settled", "what a scene costs in which all sleep, and what a body that falls into it wakes");
  const auto arguments = std::make_shared<Arguments>();
  SettledSettings& settings = arguments->bench;
  command->add_option("--bodies", settings.bodies, "at rest on a plane")
      ->check(CLI::Range(1, 4'000'000))
      ->capture_default_str();
  command->add_option("--model", arguments->model, "of the statistical level: this one only")
      ->check(CLI::IsMember({"tables", "support"}));
  command->add_option("--threads", settings.threads, "of the statistical level")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--steps", settings.steps, "of 1/60 s, timed in each state of the scene")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command->add_option("--speed", settings.speed, "of the body that falls in, m/s")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "file for the table, one line a row");
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    run_bench(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
