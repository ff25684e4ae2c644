// The arguments that say how drops are compared, alike for every command that compares them.
#pragma once

#include <string>
#include <vector>

#include "tools/compare/drop_comparison.h"
#include "tools/signature_arguments.h"

namespace lodestone {

struct ComparisonArguments {
  SignatureArguments signature;
  DropComparisonSettings comparison;
  std::vector<std::string> steps = {"1/60"};
  /// Without a progress function.
  DropComparisonSettings settings() const;
};

/// Adds --methods to `command`: some of those that make_methods knows, others are refused. `methods`
/// holds the default and outlives the parsing. `what`: in place of a list of them in --help.
void add_methods_argument(Command& command, std::vector<std::string>& methods, const std::string& what = "");

/// Adds --model to `command`: that of the statistical level's models whose rows are asked for; empty: all.
void add_model_argument(Command& command, std::string& model);

/// Adds --dt to `command`: texts for steps_of() (tools/step_argument.h).
void add_steps_argument(Command& command, std::vector<std::string>& steps);

void add_trials_argument(Command& command, int& trials, const std::string& what);

/// Adds --seed and --threads to `command`.
void add_starts_arguments(Command& command, std::uint64_t& seed, int& threads);

/// Adds --dt, --trials, --methods, --truth-push, --truth-substeps, --seed, --threads and the options of
/// signatures to `command`, with the defaults in `arguments`, which outlives the parsing.
void add_comparison_arguments(Command& command, ComparisonArguments& arguments);

}  // namespace lodestone
