#include "tools/compare/comparison_arguments.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/step_argument.h"

namespace lodestone {
namespace {

/// Empty where there is none.
std::string find_method_fault(const std::string& name) {
  if (is_drop_method(name)) return "";
  return fmt::format("found '{}', expected some of {}, full_2 to full_64", name, fmt::join(drop_method_names(), ", "));
}

}  // namespace

DropComparisonSettings ComparisonArguments::settings() const {
  DropComparisonSettings settings = comparison;
  settings.measuring = signature.measuring();
  settings.dt_s = steps_of(steps);
  return settings;
}

void add_comparison_arguments(CLI::App& command, ComparisonArguments& arguments) {
  DropComparisonSettings& comparison = arguments.comparison;
  add_signature_arguments(command, arguments.signature);
  command.add_option("--dt", arguments.steps, "steps of the methods, s: 0.01 or 1/60, several with commas")
      ->delimiter(',')->allow_extra_args(false)->check(find_step_fault, "SECONDS")->capture_default_str();
  command.add_option("--trials", comparison.trials, "drops of each")->check(CLI::Range(2, 1'000'000))->capture_default_str();
  command.add_option("--methods", comparison.methods, fmt::format("some of {}; full_N for the full level at N substeps", fmt::join(drop_method_names(), ",")))
      ->delimiter(',')->allow_extra_args(false)->check(find_method_fault, "METHODS")->capture_default_str();
  command.add_option("--seed", comparison.seed, "of the starts")->capture_default_str();
  command.add_option("--threads", comparison.threads, "0: all cores")->check(CLI::Range(0, 4096))->capture_default_str();
}

}  // namespace lodestone
