#include "tools/compare/command_compare_errors.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/compare/comparison_arguments.h"
#include "tools/compare/rung_error_measure.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  SignatureArguments signature;
  DropComparisonSettings comparison;
  bool keep = false, json = false;
};

void compare_errors(const Arguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  DropComparisonSettings settings = arguments.comparison;
  settings.measuring = arguments.signature.measuring();
  RungErrorMeasurement measured;
  {
    ProgressLine line;
    settings.progress = line.function();
    measured = measure_rung_errors(job, settings);
  }
  const RungErrors& errors = measured.errors;
  std::string file;
  if (arguments.keep) {
    SignatureSourceSettings source;
    source.measuring = settings.measuring;
    file = rung_errors_file(*job.shape, job.law(), source).string();
    save_rung_errors(errors, file);
  }
  const std::array<std::pair<const char*, RungError>, 3> rungs{
      {{"full", errors.full}, {"support", errors.support}, {"tables", errors.tables}}};
  if (arguments.json) {
    nlohmann::ordered_json json{{"shape", job.shape->name},
                                {"drops", errors.drops},
                                {"floor", {{"score", measured.floor}, {"drift", measured.floor_drift}}}};
    for (const auto& [name, error] : rungs)
      json["rungs"][name] = {{"score", error.score}, {"drift", error.drift}};
    json["file"] = file.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(file);
    print_json(json);
    return;
  }
  fmt::print(
      "{}, {} drops at 1/60 s: score, and mean distance after 1 s from where the truth has the body, over "
      "its size\n",
      job.shape->name, errors.drops);
  fmt::print("{:<12} {:.3f}  {:.3f}\n", "noise floor", measured.floor, measured.floor_drift);
  for (const auto& [name, error] : rungs)
    fmt::print("{:<12} {:.3f}  {:.3f}\n", name, error.score, error.drift);
  if (!file.empty()) fmt::print("kept in {}\n", file);
}

}  // namespace

void add_compare_errors_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* errors =
      compare.add_subcommand("errors", "each rung's error for a shape, which an error budget goes by");
  const auto arguments = std::make_shared<Arguments>();
  add_shape_arguments(*errors, arguments->shape);
  add_signature_arguments(*errors, arguments->signature);
  errors->add_option("--trials", arguments->comparison.trials, "drops of each batch")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  add_starts_arguments(*errors, arguments->comparison.seed, arguments->comparison.threads);
  errors->add_flag("--keep", arguments->keep, "in the cache, beside the signature, where managers find them");
  errors->add_flag("--json", arguments->json, "one JSON object on stdout");
  errors->callback([arguments, &exit_code] {
    compare_errors(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
