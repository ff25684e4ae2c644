#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/commands.h"
#include "tools/compare/comparison_arguments.h"
#include "tools/compare/rung_error_measure.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"

namespace lodestone {
namespace {

struct CompareErrorsArguments {
  ShapeArguments shape;
  SignatureArguments signature;
  DropComparisonSettings comparison;
  bool keep = false;
  ResultArguments results;
};

std::array<std::pair<const char*, RungError>, 3> rungs_of(const RungErrors& errors) {
  return {{{"full", errors.full}, {"support", errors.support}, {"tables", errors.tables}}};
}

nlohmann::ordered_json json_of(const Shape& shape, const RungErrorMeasurement& measured,
                               const std::string& file) {
  nlohmann::ordered_json json{{"shape", shape.name},
                              {"drops", measured.errors.drops},
                              {"floor", {{"score", measured.floor}, {"drift", measured.floor_drift}}}};
  for (const auto& [name, error] : rungs_of(measured.errors))
    json["rungs"][name] = {{"score", error.score}, {"drift", error.drift}};
  json["file"] = file.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(file);
  return json;
}

std::string text_of(const Shape& shape, const RungErrorMeasurement& measured, const std::string& file) {
  std::string text = fmt::format(
      "{}, {} drops at 1/60 s: score, and mean distance after 1 s from where the truth has the body, over "
      "its size\n{:<12} {:.3f}  {:.3f}\n",
      shape.name, measured.errors.drops, "noise floor", measured.floor, measured.floor_drift);
  for (const auto& [name, error] : rungs_of(measured.errors))
    text += fmt::format("{:<12} {:.3f}  {:.3f}\n", name, error.score, error.drift);
  return file.empty() ? text : text + fmt::format("kept in {}\n", file);
}

void compare_errors(const CompareErrorsArguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  DropComparisonSettings settings = arguments.comparison;
  settings.measuring = arguments.signature.measuring();
  const RungErrorMeasurement measured =
      with_progress(settings, [&](const auto& with_line) { return measure_rung_errors(job, with_line); });
  std::string file;
  if (arguments.keep) {
    SignatureSourceSettings source;
    source.measuring = settings.measuring;
    file = rung_errors_file(*job.shape, job.law(), source).string();
    save_rung_errors(measured.errors, file);
  }
  print_results(arguments.results, json_of(*job.shape, measured, file), text_of(*job.shape, measured, file));
}

}  // namespace

void add_compare_errors_command(Command& compare) {
  auto [errors, arguments] = compare.add<CompareErrorsArguments>(
      "errors", "each rung's error for a shape, which an error budget goes by", compare_errors);
  add_shape_arguments(errors, arguments.shape);
  add_signature_arguments(errors, arguments.signature);
  add_trials_argument(errors, arguments.comparison.trials, "drops of each batch");
  add_starts_arguments(errors, arguments.comparison.seed, arguments.comparison.threads);
  errors.add_flag("--keep", arguments.keep, "in the cache, beside the signature, where managers find them");
  add_json_argument(errors, arguments.results);
}

}  // namespace lodestone
