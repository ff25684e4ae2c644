#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/compare/drop_report.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"

namespace lodestone {
namespace {

struct CompareDropArguments {
  ShapeArguments shape;
  ComparisonArguments comparison;
  double speed_scale = 1.0, slope_deg = 0.0;
  std::filesystem::path out;
  ResultArguments results;
};

DropJob make_job(const CompareDropArguments& arguments) {
  DropJob job;
  job.shape = make_shape_from_arguments(arguments.shape);
  job.material = arguments.shape.material;
  job.conditions.speed_scale = arguments.speed_scale;
  job.conditions.slope = arguments.slope_deg * std::numbers::pi / 180.0;
  return job;
}

void compare_drop(const CompareDropArguments& arguments) {
  const DropJob job = make_job(arguments);
  DropComparisonSettings settings = arguments.comparison.settings();
  const DropComparison comparison =
      with_progress(settings, [&](const auto& with_line) { return compare_drops(job, with_line); });
  print_results(arguments.results, json_of(comparison), text_of(job, comparison));
  if (!arguments.out.empty()) save_drops(comparison, arguments.out);
  if (!arguments.results.csv.empty()) save_scores(comparison, arguments.results.csv);
}

}  // namespace

void add_compare_drop_command(Command& compare) {
  auto [drop, arguments] = compare.add<CompareDropArguments>(
      "drop", "single bodies dropped on a plane, by each method and by the truth", compare_drop);
  add_shape_arguments(drop, arguments.shape);
  add_comparison_arguments(drop, arguments.comparison);
  drop.add_option("--speed-scale", arguments.speed_scale, "multiplies the starting speeds").within(0.0, 1e3);
  drop.add_option("--slope-deg", arguments.slope_deg, "of the plane").within(0.0, 80.0);
  drop.add_option("--out", arguments.out, "folder for drops.csv, one line a drop").written_into();
  add_table_arguments(drop, arguments.results, "file for the scores, one line a row");
}

}  // namespace lodestone
