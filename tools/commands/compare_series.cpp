#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/compare/drop_series.h"
#include "tools/compare/series_parts.h"
#include "tools/compare/unseen_shapes.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"

namespace lodestone {
namespace {

struct SeriesArguments {
  ComparisonArguments comparison;
  std::vector<std::string> only;
  std::optional<Share> share;
  bool costs = false;
  ResultArguments results;
};

struct ShapesArguments : SeriesArguments {
  Material material;
};

struct ConditionsArguments : SeriesArguments {
  ShapeArguments shape;
};

using MaterialsArguments = ConditionsArguments;

void add_common_arguments(Command& command, SeriesArguments& arguments) {
  add_share_argument(command, arguments.share,
                     "compare one share of the rows, the I-th of N; --json prints its part (see merge)");
  command.add_flag("--costs", arguments.costs, "measure what a step costs, too");
  add_json_argument(command, arguments.results);
}

void add_series_arguments(Command& command, SeriesArguments& arguments, std::vector<std::string> names) {
  arguments.comparison.comparison.methods = {"full_1", "statistical"};
  add_comparison_arguments(command, arguments.comparison);
  command.add_option("--only", arguments.only, "some of the rows, with commas")
      .several()
      .one_of(std::move(names));
  add_common_arguments(command, arguments);
}

bool is_chosen(std::string_view name, const std::vector<std::string>& only) {
  return only.empty() || std::ranges::count(only, name) > 0;
}

std::vector<DropComparison> compare(const std::vector<DropCase>& cases, const SeriesArguments& arguments) {
  DropComparisonSettings settings = arguments.comparison.settings();
  settings.costs = arguments.costs;
  return with_progress(settings, [&](const auto& with_line) { return compare_series(cases, with_line); });
}

// Of the signatures that the statistical level goes by.
nlohmann::ordered_json json_of(const SignatureSettings& measuring) {
  constexpr std::array kDraws = {"independent", "correlated", "empirical"};
  return {{"paper_grid", measuring.paper_grid},
          {"trial_end", measuring.trial_end == TrialEnd::first_impulse ? "first-impulse" : "leaves-plane"},
          {"psi", measuring.n_psi},
          {"draw", kDraws.at(std::size_t(measuring.draw))},
          {"table_error", measuring.table_error},
          {"cell_trials", measuring.trials_per_cell},
          {"height_trials", measuring.height_trials},
          {"settling_trials", measuring.settling_trials},
          {"clips", measuring.clips}};
}

// A part says what series it is of, though it may have no row of it: merge takes parts of one alone. `of`:
// what all rows share.
nlohmann::ordered_json with_share(nlohmann::ordered_json json, const SeriesArguments& arguments,
                                  const nlohmann::ordered_json& of) {
  if (!arguments.share) return json;
  const DropComparisonSettings settings = arguments.comparison.settings();
  nlohmann::ordered_json& series = json["series"] = of;
  series["methods"] = settings.methods;
  series["dt_s"] = settings.dt_s;
  series["seed"] = settings.seed;
  if (settings.truth.push_m_per_s) series["truth_push_m_per_s"] = *settings.truth.push_m_per_s;
  if (settings.truth.substeps) series["truth_substeps"] = *settings.truth.substeps;
  series["only"] = arguments.only;
  series["signature"] = json_of(settings.measuring);
  json["trials"] = settings.trials;
  json["shard"] = fmt::format("{}/{}", arguments.share->index + 1, arguments.share->count);
  return json;
}

nlohmann::ordered_json json_of(const Material& material) {
  return {
      {"restitution", material.restitution}, {"friction", material.friction}, {"density", material.density}};
}

nlohmann::ordered_json json_of(const char* kind, const DropJob& job) {
  return {{"of", kind},
          {"shape", job.shape->name},
          {"mesh_hash", fmt::format("{:016x}", hash_of(job.shape->mesh))},
          {"material", json_of(job.material)}};
}

void compare_shapes(const ShapesArguments& arguments) {
  std::vector<DropCase> cases;
  for (const UnseenShape& shape : unseen_shapes())
    if (is_chosen(shape.name, arguments.only))
      cases.push_back(
          {std::string(shape.name),
           {.shape = make_unseen_shape(shape.name), .conditions = {}, .material = arguments.material},
           int(cases.size())});
  keep_share(cases, arguments.share.value_or(Share{}), false);
  const std::vector<DropComparison> series = compare(cases, arguments);
  print_results(arguments.results,
                with_share(json_of("shape", cases, series, false), arguments,
                           {{"of", "shapes"}, {"material", json_of(arguments.material)}}),
                text_of("shape", cases, series, false));
}

DropJob usual_job(const ConditionsArguments& arguments) {
  return {.shape = make_shape_from_arguments(arguments.shape),
          .conditions = {},
          .material = arguments.shape.material};
}

void compare_conditions(const ConditionsArguments& arguments) {
  const DropJob usual = usual_job(arguments);
  std::vector<DropCase> cases = make_condition_cases(usual);
  const auto others = cases.begin() + 1;  // the usual ones stay, as what the others are compared with
  cases.erase(std::remove_if(others, cases.end(),
                             [&](const DropCase& one) { return !is_chosen(one.name, arguments.only); }),
              cases.end());
  keep_share(cases, arguments.share.value_or(Share{}), true);
  const std::vector<DropComparison> series = compare(cases, arguments);
  print_results(
      arguments.results,
      with_share(json_of("condition", cases, series, true), arguments, json_of("conditions", usual)),
      text_of("condition", cases, series, true));
}

void compare_materials(const MaterialsArguments& arguments) {
  const DropJob usual = usual_job(arguments);
  std::vector<DropCase> cases = make_material_cases(usual);
  keep_share(cases, arguments.share.value_or(Share{}), false);
  const std::vector<DropComparison> series = compare(cases, arguments);
  const auto json =
      with_share(json_of("materials", cases, series, false), arguments, json_of("materials", usual));
  print_results(arguments.results, json, material_tables_of(json));
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const UnseenShape& shape : unseen_shapes()) names.emplace_back(shape.name);
  return names;
}

}  // namespace

void add_compare_shapes_command(Command& compare) {
  auto [shapes, arguments] =
      compare.add<ShapesArguments>("shapes", "drops of shapes that nothing was tuned on", compare_shapes);
  add_series_arguments(shapes, arguments, shape_names());
  add_material_arguments(shapes, arguments.material);
}

void add_compare_materials_command(Command& compare) {
  auto [materials, arguments] = compare.add<MaterialsArguments>(
      "materials", "drops of a shape with every pair of six restitutions and five frictions",
      compare_materials);
  arguments.comparison.comparison.trials = 200;
  arguments.comparison.comparison.methods = {"statistical"};
  add_shape_arguments(materials, arguments.shape);
  add_comparison_arguments(materials, arguments.comparison);
  add_common_arguments(materials, arguments);
}

void add_compare_conditions_command(Command& compare) {
  auto [conditions, arguments] = compare.add<ConditionsArguments>(
      "conditions", "drops of a shape with other materials, speeds, slopes, sizes, ground",
      compare_conditions);
  arguments.comparison.comparison.trials = 200;
  add_shape_arguments(conditions, arguments.shape);
  add_series_arguments(conditions, arguments, condition_names());
}

}  // namespace lodestone
