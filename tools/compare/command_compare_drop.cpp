#include "tools/compare/command_compare_drop.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <numbers>

#include "tools/compare/comparison_arguments.h"
#include "tools/compare/drop_report.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  ComparisonArguments comparison;
  double speed_scale = 1.0, slope_deg = 0.0;
  std::filesystem::path out, csv;
  bool json = false;
};

DropJob make_job(const Arguments& arguments) {
  DropJob job;
  job.shape = make_shape_from_arguments(arguments.shape);
  job.material = arguments.shape.material;
  job.conditions.speed_scale = arguments.speed_scale;
  job.conditions.slope = arguments.slope_deg * std::numbers::pi / 180.0;
  return job;
}

void compare_drop(const Arguments& arguments) {
  const DropJob job = make_job(arguments);
  DropComparisonSettings settings = arguments.comparison.settings();
  DropComparison comparison;
  {
    ProgressLine line;
    settings.progress = line.function();
    comparison = compare_drops(job, settings);
  }
  if (!arguments.out.empty()) save_drops(comparison, arguments.out);
  if (!arguments.csv.empty()) save_scores(comparison, arguments.csv);
  if (arguments.json)
    print_json(json_of(comparison));
  else
    fmt::print("{}", text_of(job, comparison));
}

}  // namespace

void add_compare_drop_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* drop =
      compare.add_subcommand("drop", "single bodies dropped on a plane, by each method and by the truth");
  const auto arguments = std::make_shared<Arguments>();
  add_shape_arguments(*drop, arguments->shape);
  add_comparison_arguments(*drop, arguments->comparison);
  drop->add_option("--speed-scale", arguments->speed_scale, "multiplies the starting speeds")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  drop->add_option("--slope-deg", arguments->slope_deg, "of the plane")
      ->check(CLI::Range(0.0, 80.0))
      ->capture_default_str();
  drop->add_option("--out", arguments->out, "folder for drops.csv, one line a drop");
  drop->add_option("--csv", arguments->csv, "file for the scores, one line a row");
  drop->add_flag("--json", arguments->json, "one JSON object on stdout");
  drop->callback([arguments, &exit_code] {
    compare_drop(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
