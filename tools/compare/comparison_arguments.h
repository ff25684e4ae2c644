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

/// Adds --seed and --threads to `command`.
void add_starts_arguments(CLI::App& command, std::uint64_t& seed, int& threads);

/// Adds --dt, --trials, --methods, --seed, --threads and the options of signatures to `command`, with the
/// defaults in `arguments`, which outlives the parsing.
void add_comparison_arguments(CLI::App& command, ComparisonArguments& arguments);

}  // namespace lodestone
