// The arguments that say how a signature is measured, alike for every command that may measure one.
#pragma once

#include <optional>

#include "signature/measure/measurement.h"
#include "signature/signature.h"
#include "tools/command.h"

namespace lodestone {

struct SignatureArguments {
  SignatureSettings settings;
  std::optional<TrialEnd> trial_end;
  /// The settings; trials on the paper's grid end after the first impulse, as the paper's do, unless it was
  /// said otherwise.
  SignatureSettings measuring() const;
};

/// Adds --paper-grid, --trial-end, --psi, --draw, --table-error, --cell-trials, --height-trials,
/// --settling-trials and --clips to `command`. `arguments` outlives the parsing.
void add_signature_arguments(Command& command, SignatureArguments& arguments);

/// Adds --shard I/N, I from 1 to N, to `command`: which share of a measurement, or of a series of
/// comparisons, as `what` says. `share` outlives the parsing and stays empty where it is not given.
Option add_share_argument(Command& command, std::optional<Share>& share, const std::string& what);

}  // namespace lodestone
