#include "tools/compare/comparison_arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/methods/method.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

/// What is wrong with the name of a method; empty where nothing is.
std::string find_method_fault(const std::string& name) {
  if (is_method_name(name)) return "";
  return fmt::format("found '{}', expected some of {}, full_2 to full_64", name,
                     fmt::join(method_names(), ", "));
}

}  // namespace

DropComparisonSettings ComparisonArguments::settings() const {
  DropComparisonSettings settings = comparison;
  settings.measuring = signature.measuring();
  settings.dt_s = steps_of(steps);
  return settings;
}

void add_methods_argument(Command& command, std::vector<std::string>& methods, const std::string& what) {
  command
      .add_option("--methods", methods,
                  what.empty() ? fmt::format("some of {}; full_N for the full level at N substeps",
                                             fmt::join(method_names(), ","))
                               : what)
      .several()
      .checked(find_method_fault, "METHODS");
}

void add_steps_argument(Command& command, std::vector<std::string>& steps) {
  command.add_option("--dt", steps, "steps of the methods, s: 0.01 or 1/60, several with commas")
      .several()
      .checked(find_step_fault, "SECONDS");
}

void add_trials_argument(Command& command, int& trials, const std::string& what) {
  command.add_option("--trials", trials, what).within(2, 1'000'000);
}

void add_model_argument(Command& command, std::string& model) {
  command.add_option("--model", model, "of the statistical level: this one only")
      .one_of({"tables", "tables_published", "support"});
}

void add_starts_arguments(Command& command, std::uint64_t& seed, int& threads) {
  command.add_option("--seed", seed, "of the starts");
  command.add_option("--threads", threads, "0: all cores").within(0, 4096);
}

void add_comparison_arguments(Command& command, ComparisonArguments& arguments) {
  DropComparisonSettings& comparison = arguments.comparison;
  add_signature_arguments(command, arguments.signature);
  add_steps_argument(command, arguments.steps);
  add_trials_argument(command, comparison.trials, "drops of each");
  add_methods_argument(command, comparison.methods);
  command
      .add_option(
          "--truth-push", comparison.truth.push_m_per_s,
          "how fast the truth pushes overlap apart, m/s, at most; without, as ODE does, so that nothing "
          "bounces by less than a part of its speed, up to .2")
      .within(0.0, 1e9);
  command
      .add_option("--truth-substeps", comparison.truth.substeps,
                  "how many steps the truth takes in 1/60 s; without 34, more for bodies below .2 m")
      .within(1, 100'000);
  add_starts_arguments(command, comparison.seed, comparison.threads);
}

}  // namespace lodestone
