#include "tools/compare/command_compare_pile.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tools/compare/comparison_arguments.h"
#include "tools/compare/method_argument.h"
#include "tools/compare/pile_report.h"
#include "tools/progress.h"
#include "tools/results.h"
#include "tools/shape_arguments.h"
#include "tools/signature_arguments.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

struct Arguments {
  ShapeArguments shape;
  SignatureArguments signature;
  PileComparisonSettings comparison;
  std::vector<std::string> steps = {"1/60"};
  std::filesystem::path out;
  bool json = false;
};

void compare_pile(const Arguments& arguments) {
  const DropJob job{.shape = make_shape_from_arguments(arguments.shape),
                    .conditions = {},
                    .material = arguments.shape.material};
  PileComparisonSettings settings = arguments.comparison;
  settings.measuring = arguments.signature.measuring();
  settings.dt_s = steps_of(arguments.steps);
  PileComparison comparison;
  {
    ProgressLine line;
    settings.progress = line.function();
    comparison = compare_piles(job, settings);
  }
  if (!arguments.out.empty()) save_piles(comparison, arguments.out);
  if (arguments.json)
    print_json(json_of(comparison));
  else
    fmt::print("{}", text_of(job, comparison));
}

}  // namespace

void add_compare_pile_command(CLI::App& compare, ExitCode& exit_code) {
  CLI::App* pile =
      compare.add_subcommand("pile", "bodies poured into a bin, by each method and by the truth");
  const auto arguments = std::make_shared<Arguments>();
  PileComparisonSettings& comparison = arguments->comparison;
  add_shape_arguments(*pile, arguments->shape);
  add_signature_arguments(*pile, arguments->signature);
  pile->add_option("--bodies", comparison.conditions.bodies, "in a pile")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  pile->add_option("--side", comparison.conditions.side, "of the bin's square floor, m")
      ->check(CLI::Range(1e-3, 1e3))
      ->capture_default_str();
  pile->add_option("--seeds", comparison.piles, "piles of each method")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  pile->add_option("--dt", arguments->steps, "steps of the methods, s: 0.01 or 1/60, several with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(find_step_fault, "SECONDS")
      ->capture_default_str();
  add_methods_argument(*pile, comparison.methods);
  add_starts_arguments(*pile, comparison.seed, comparison.threads);
  pile->add_option("--out", arguments->out, "folder for piles.csv, one line a pile, and pile_energy.csv");
  pile->add_flag("--json", arguments->json, "one JSON object on stdout");
  pile->callback([arguments, &exit_code] {
    compare_pile(*arguments);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
