#include "tools/compare/command_compare_series.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "tools/compare/comparison_arguments.h"
#include "tools/compare/drop_series.h"
#include "tools/compare/unseen_shapes.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"

namespace lodestone {
namespace {

struct SeriesArguments {
  ComparisonArguments comparison;
  std::vector<std::string> only;
  bool costs = false, json = false;
};

struct ShapesArguments : SeriesArguments {
  Material material;
};

struct ConditionsArguments : SeriesArguments {
  ShapeArguments shape;
};

void add_series_arguments(CLI::App& command, SeriesArguments& arguments, std::vector<std::string> names) {
  arguments.comparison.comparison.methods = {"full_1", "statistical"};
  add_comparison_arguments(command, arguments.comparison);
  command.add_option("--only", arguments.only, "some of the rows, with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(std::move(names)));
  command.add_flag("--costs", arguments.costs, "measure what a step costs, too");
  command.add_flag("--json", arguments.json, "one JSON object on stdout");
}

bool is_chosen(std::string_view name, const std::vector<std::string>& only) {
  return only.empty() || std::ranges::count(only, name) > 0;
}

std::vector<DropComparison> compare(const std::vector<DropCase>& cases, const SeriesArguments& arguments) {
  ProgressLine line;
  DropComparisonSettings settings = arguments.comparison.settings();
  settings.costs = arguments.costs;
  settings.progress = line.function();
  return compare_series(cases, settings);
}

void compare_shapes(const ShapesArguments& arguments) {
  std::vector<DropCase> cases;
  for (const UnseenShape& shape : unseen_shapes())
    if (is_chosen(shape.name, arguments.only))
      cases.push_back(
          {std::string(shape.name),
           {.shape = make_unseen_shape(shape.name), .conditions = {}, .material = arguments.material}});
  const std::vector<DropComparison> series = compare(cases, arguments);
  if (arguments.json)
    print_json(json_of("shape", cases, series, false));
  else
    fmt::print("{}", text_of("shape", cases, series, false));
}

DropJob usual_job(const ConditionsArguments& arguments) {
  return {.shape = make_shape_from_arguments(arguments.shape),
          .conditions = {},
          .material = arguments.shape.material};
}

void compare_conditions(const ConditionsArguments& arguments) {
  std::vector<DropCase> cases = make_condition_cases(usual_job(arguments));
  const auto others = cases.begin() + 1;  // the usual ones stay, as what the others are compared with
  cases.erase(std::remove_if(others, cases.end(),
                             [&](const DropCase& one) { return !is_chosen(one.name, arguments.only); }),
              cases.end());
  const std::vector<DropComparison> series = compare(cases, arguments);
  if (arguments.json)
    print_json(json_of("condition", cases, series, true));
  else
    fmt::print("{}", text_of("condition", cases, series, true));
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const UnseenShape& shape : unseen_shapes()) names.emplace_back(shape.name);
  return names;
}

}  // namespace

void add_compare_shapes_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* shapes = compare.add_subcommand("shapes", "drops of shapes that nothing was tuned on");
  const auto arguments = std::make_shared<ShapesArguments>();
  add_series_arguments(*shapes, *arguments, shape_names());
  add_material_arguments(*shapes, arguments->material);
  shapes->callback([arguments, &exit_code] {
    compare_shapes(*arguments);
    exit_code = ExitCode::done;
  });
}

void add_compare_conditions_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* conditions =
      compare.add_subcommand("conditions", "drops of a shape with other materials, speeds, slopes and sizes");
  const auto arguments = std::make_shared<ConditionsArguments>();
  arguments->comparison.comparison.trials = 200;
  add_shape_arguments(*conditions, arguments->shape);
  add_series_arguments(*conditions, *arguments, condition_names());
  conditions->callback([arguments, &exit_code] {
    compare_conditions(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
