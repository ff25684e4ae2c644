#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/drops_bench.h"
#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchDropsArguments {
  ShapeArguments shape;
  DropsSettings bench;
  ResultArguments results;
};

std::string text_of(const std::vector<DropsRow>& rows) {
  TextTable table({"method", "ns per body-step", "seconds", "awake"});
  std::string reasons;
  for (const DropsRow& row : rows) {
    const std::string name = row.model.empty() ? row.method : fmt::format("{} {}", row.method, row.model);
    if (row.seconds)
      table.add_row({name, fmt::format("{:.0f}", *row.ns_per_body_step), fmt::format("{:.3f}", *row.seconds),
                     fmt::format("{:.1f}", *row.awake)});
    else
      reasons += fmt::format("left out: {}: {}\n", name, row.left_out);
  }
  return table.text() + (reasons.empty() ? "" : '\n' + reasons);
}

ordered_json json_of(const DropsRow& row) {
  return {{"method", row.method},
          {"model", or_null(row.model)},
          {"ns_per_body_step", or_null(row.ns_per_body_step)},
          {"seconds", or_null(row.seconds)},
          {"awake", or_null(row.awake)},
          {"awake_body_steps", row.awake_body_steps},
          {"reason", or_null(row.left_out)}};
}

void run_drops(const BenchDropsArguments& arguments) {
  const auto shape = make_shape_from_arguments(arguments.shape);
  const DropJob job{.shape = shape, .conditions = {}, .material = arguments.shape.material};
  const std::vector<DropsRow> rows = with_progress(
      arguments.bench, [&](const DropsSettings& settings) { return bench_drops(job, settings); });
  ordered_json json = {{"shape", shape->name}, {"bodies", arguments.bench.bodies}, {"steps", kDropsSteps}};
  json["rows"] = ordered_json::array();
  for (const DropsRow& row : rows) json["rows"].push_back(json_of(row));
  print_table(arguments.results, json, json_of(DropsRow{}),
              fmt::format("{} of {} too far apart to touch, {} steps of 1/60 s, sleep on: {} time of "
                          "whole steps, per body that is awake; how many are, on average\n\n{}",
                          arguments.bench.bodies, shape->name, kDropsSteps,
                          arguments.bench.threads == 1 ? "processor" : "wall", text_of(rows)));
}

}  // namespace

void add_bench_drops_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchDropsArguments>(
      "drops", "what bodies cost that are too far apart to touch, broad phase and sleepers counted",
      run_drops);
  DropsSettings& settings = arguments.bench;
  add_shape_arguments(command, arguments.shape);
  command.add_option("--bodies", settings.bodies, "in one world").within(1, 1'000'000);
  add_methods_argument(command, settings.methods,
                       "of compare drop; the statistical level with all of its models");
  add_model_argument(command, settings.model);
  command.add_option("--threads", settings.threads, "of the statistical level").within(1, 4096);
  command.add_option("--seed", settings.seed, "of the starts");
  add_table_arguments(command, arguments.results);
}

}  // namespace lodestone
