#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/churn_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

struct BenchChurnArguments {
  ChurnSettings bench;
  ResultArguments results;
};

std::string text_of(const std::vector<ChurnRow>& rows) {
  TextTable table({"rung", "asleep", "bodies", "first step ms", "a frame", "removal us", "addition us",
                   "step ms", "while churned", "frame ms"});
  for (const ChurnRow& row : rows)
    table.add_row({std::string(name_of(row.rung)), row.asleep ? "yes" : "no", fmt::format("{}", row.bodies),
                   fmt::format("{:.1f}", row.first_step_ms), fmt::format("{}", row.churned),
                   fmt::format("{:.2f}", row.removal_us), fmt::format("{:.2f}", row.addition_us),
                   fmt::format("{:.3f}", row.step_ms), fmt::format("{:.3f}", row.churned_step_ms),
                   fmt::format("{:.3f}", row.frame_ms())});
  return table.text();
}

ordered_json json_of(const ChurnRow& row) {
  return {{"rung", name_of(row.rung)},
          {"asleep", row.asleep},
          {"bodies", row.bodies},
          {"first_step_ms", row.first_step_ms},
          {"churned", row.churned},
          {"removal_us", row.removal_us},
          {"addition_us", row.addition_us},
          {"step_ms", row.step_ms},
          {"churned_step_ms", row.churned_step_ms},
          {"frame_ms", row.frame_ms()}};
}

void run_churn(BenchChurnArguments arguments) {
  const std::vector<ChurnRow> rows = with_progress(arguments.bench, bench_churn);
  ordered_json json = {{"rows", ordered_json::array()}};
  for (const ChurnRow& row : rows) json["rows"].push_back(json_of(row));
  print_results(arguments.results, json,
                fmt::format("crates, each of a mass of its own, that come and go, {} of each a second: "
                            "medians; the last column "
                            "is what this takes in a frame, calls and step together\n\n{}",
                            arguments.bench.per_second, text_of(rows)));
}

}  // namespace

void add_bench_churn_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchChurnArguments>(
      "churn", "what it costs to add and remove bodies all the time", run_churn);
  ChurnSettings& settings = arguments.bench;
  command.add_option("--bodies", settings.bodies, "in the world").within(1, 4'000'000);
  command.add_option("--full-bodies", settings.full_bodies, "in the world, where they are full")
      .within(1, 100'000);
  command.add_option("--per-second", settings.per_second, "bodies added, and as many removed")
      .within(60, 1'000'000);
  command.add_option("--frames", settings.frames, "of 1/60 s").within(1, 100'000);
  command.add_option("--threads", settings.threads, "of the statistical level").within(1, 4096);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
