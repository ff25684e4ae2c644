#include "tools/compare/comparison_arguments.h"

#include <CLI/CLI.hpp>

#include "tools/compare/method_argument.h"
#include "tools/step_argument.h"

namespace lodestone {

DropComparisonSettings ComparisonArguments::settings() const {
  DropComparisonSettings settings = comparison;
  settings.measuring = signature.measuring();
  settings.dt_s = steps_of(steps);
  return settings;
}

void add_starts_arguments(CLI::App& command, std::uint64_t& seed, int& threads) {
  command.add_option("--seed", seed, "of the starts")->capture_default_str();
  command.add_option("--threads", threads, "0: all cores")->check(CLI::Range(0, 4096))->capture_default_str();
}

void add_comparison_arguments(CLI::App& command, ComparisonArguments& arguments) {
  DropComparisonSettings& comparison = arguments.comparison;
  add_signature_arguments(command, arguments.signature);
  command.add_option("--dt", arguments.steps, "steps of the methods, s: 0.01 or 1/60, several with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(find_step_fault, "SECONDS")
      ->capture_default_str();
  command.add_option("--trials", comparison.trials, "drops of each")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  add_methods_argument(command, comparison.methods);
  add_starts_arguments(command, comparison.seed, comparison.threads);
}

}  // namespace lodestone
