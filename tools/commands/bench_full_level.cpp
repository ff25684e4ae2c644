#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "tools/bench/full_level_bench.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

struct BenchFullLevelArguments {
  ShapeArguments shape;
  FullLevelBenchSettings bench;
  ResultArguments results;
};

std::string text_of(const DropJob& job, const BenchFullLevelArguments& arguments,
                    const std::vector<FullLevelBenchRow>& rows) {
  TextTable table({"method", "substeps", "falling ms", "step ms", "times less"});
  for (const FullLevelBenchRow& row : rows) {
    if (!row.left_out.empty()) continue;
    table.add_row({row.method, fmt::format("{}", row.substeps), fmt::format("{:.3f}", row.falling_ms),
                   fmt::format("{:.3f}", row.step_ms), fmt::format("{:.1f}", row.times_less)});
  }
  return fmt::format(
      "{}, {} faces: {} bodies fall on a plane, {} steps of 1/60 s, medians of a step of all\n\n{}",
      job.shape->name, job.shape->mesh.faces.size(), arguments.bench.bodies, arguments.bench.steps,
      table.text());
}

nlohmann::ordered_json json_of(const DropJob& job, const BenchFullLevelArguments& arguments,
                               const std::vector<FullLevelBenchRow>& rows) {
  nlohmann::ordered_json json = {{"shape", job.shape->name},
                                 {"faces", job.shape->mesh.faces.size()},
                                 {"bodies", arguments.bench.bodies},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const FullLevelBenchRow& row : rows) {
    const bool measured = row.left_out.empty();
    const auto or_null = [&](double value) {
      return measured ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    json["rows"].push_back(
        {{"method", row.method},
         {"substeps", row.substeps},
         {"falling_ms", or_null(row.falling_ms)},
         {"step_ms", or_null(row.step_ms)},
         {"times_less", or_null(row.times_less)},
         {"reason", measured ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(row.left_out)}});
  }
  return json;
}

void run_full_level(const BenchFullLevelArguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  const std::vector<FullLevelBenchRow> rows =
      with_progress(arguments.bench, [&](const auto& with_line) { return bench_full_level(job, with_line); });
  print_results(arguments.results, json_of(job, arguments, rows), text_of(job, arguments, rows));
}

}  // namespace

void add_bench_full_level_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchFullLevelArguments>(
      "full_level", "what contacts with a plane cost: plain ODE beside ours, in the same run",
      run_full_level);
  add_shape_arguments(command, arguments.shape);
  command.add_option("--bodies", arguments.bench.bodies, "too far apart to touch").within(1, 10'000);
  command.add_option("--steps", arguments.bench.steps, "of 1/60 s").within(10, 100'000);
  command
      .add_option("--methods", arguments.bench.methods,
                  "of compare drop; the first is what the others are compared with")
      .several();
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
