#include "tools/bench/command_bench_full_level.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/bench/full_level_bench.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  FullLevelBenchSettings bench;
  bool json = false;
};

std::string text_of(const DropJob& job, const Arguments& arguments,
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

nlohmann::ordered_json json_of(const DropJob& job, const Arguments& arguments,
                               const std::vector<FullLevelBenchRow>& rows) {
  nlohmann::ordered_json json = {{"shape", job.shape->name},
                                 {"faces", job.shape->mesh.faces.size()},
                                 {"bodies", arguments.bench.bodies}};
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

void bench_full_level(Arguments arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  std::vector<FullLevelBenchRow> rows;
  {
    ProgressLine line;
    arguments.bench.progress = line.function();
    rows = bench_full_level(job, arguments.bench);
  }
  if (arguments.json)
    print_json(json_of(job, arguments, rows));
  else
    fmt::print("{}", text_of(job, arguments, rows));
}

}  // namespace

void add_bench_full_level_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "full_level", "what contacts with a plane cost: plain ODE beside ours, in the same run");
  const auto arguments = std::make_shared<Arguments>();
  add_shape_arguments(*command, arguments->shape);
  command->add_option("--bodies", arguments->bench.bodies, "too far apart to touch")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--steps", arguments->bench.steps, "of 1/60 s")
      ->check(CLI::Range(10, 100'000))
      ->capture_default_str();
  command
      ->add_option("--methods", arguments->bench.methods,
                   "of compare drop; the first is what the others are compared with")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    bench_full_level(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
