#include "tools/compare/command_compare_drop.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <numbers>

#include "tools/compare/drop_report.h"
#include "tools/compare/method_argument.h"
#include "tools/progress.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  SignatureArguments signature;
  DropComparisonSettings comparison;
  std::vector<std::string> steps = {"1/60"};
  double speed_scale = 1.0, slope_deg = 0.0;
  std::filesystem::path out;
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
  DropComparisonSettings settings = arguments.comparison;
  settings.measuring = arguments.signature.measuring();
  settings.dt_s = steps_of(arguments.steps);
  DropComparison comparison;
  {
    ProgressLine line;
    settings.progress = line.function();
    comparison = compare_drops(job, settings);
  }
  if (!arguments.out.empty()) save_drops(comparison, arguments.out);
  if (arguments.json) fmt::print("{}\n", json_of(comparison).dump(2));
  else fmt::print("{}", text_of(job, comparison));
}

}  // namespace

void add_compare_drop_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* drop = compare.add_subcommand("drop", "single bodies dropped on a plane, by each method and by the truth");
  const auto arguments = std::make_shared<Arguments>();
  DropComparisonSettings& comparison = arguments->comparison;
  add_shape_arguments(*drop, arguments->shape);
  add_signature_arguments(*drop, arguments->signature);
  drop->add_option("--dt", arguments->steps, "steps of the methods, s: 0.01 or 1/60, several with commas")
      ->delimiter(',')->allow_extra_args(false)->check(find_step_fault, "SECONDS")->capture_default_str();
  drop->add_option("--trials", comparison.trials, "drops of each")->check(CLI::Range(2, 1'000'000))->capture_default_str();
  add_methods_argument(*drop, comparison.methods);
  drop->add_option("--seed", comparison.seed, "of the starts")->capture_default_str();
  drop->add_option("--speed-scale", arguments->speed_scale, "multiplies the starting speeds")->check(CLI::Range(0.0, 1e3))->capture_default_str();
  drop->add_option("--slope-deg", arguments->slope_deg, "of the plane")->check(CLI::Range(0.0, 80.0))->capture_default_str();
  drop->add_option("--threads", comparison.threads, "0: all cores")->check(CLI::Range(0, 4096))->capture_default_str();
  drop->add_option("--out", arguments->out, "folder for drops.csv, one line a drop");
  drop->add_flag("--json", arguments->json, "one JSON object on stdout");
  drop->callback([arguments, &exit_code] {
    compare_drop(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
