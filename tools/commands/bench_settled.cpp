#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/settled_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchSettledArguments {
  SettledSettings bench;
  std::string model;
  ResultArguments results;
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

void run_settled(BenchSettledArguments arguments) {
  if (!arguments.model.empty())
    arguments.bench.models = {arguments.model == "tables" ? StatisticalModel::tables
                                                          : StatisticalModel::support};
  const std::vector<SettledRow> rows = with_progress(arguments.bench, bench_settled);
  ordered_json json = {{"rows", ordered_json::array()}};
  for (const SettledRow& row : rows) json["rows"].push_back(json_of(row));
  print_table(
      arguments.results, json, json_of(SettledRow{}),
      fmt::format(
          "crates that sleep, half a metre apart: medians of a whole step of 1/60 s, in us: without "
          "viewpoints, with one, with one that moves;\n"
          "then one more falls in at {} m/s: how many are awake at once, how far from it, beyond what was "
          "looked at, and what those steps cost\n\n{}",
          arguments.bench.speed, text_of(rows)));
}

}  // namespace

void add_bench_settled_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchSettledArguments>(
      "settled", "what a scene costs in which all sleep, and what a body that falls into it wakes",
      run_settled);
  SettledSettings& settings = arguments.bench;
  command.add_option("--bodies", settings.bodies, "at rest on a plane").within(1, 4'000'000);
  command.add_option("--model", arguments.model, "of the statistical level: this one only")
      .one_of({"tables", "support"});
  command.add_option("--threads", settings.threads, "of the statistical level").within(1, 4096);
  command.add_option("--steps", settings.steps, "of 1/60 s, timed in each state of the scene")
      .within(1, 100'000);
  command.add_option("--speed", settings.speed, "of the body that falls in, m/s").within(0.1, 100.0);
  add_table_arguments(command, arguments.results);
}

}  // namespace lodestone
