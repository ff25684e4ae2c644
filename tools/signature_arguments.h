// The arguments that say how a signature is measured, alike for every command that may measure one.
#pragma once

#include <optional>

#include "signature/signature.h"

namespace CLI {
class App;
}

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
void add_signature_arguments(CLI::App& command, SignatureArguments& arguments);

}  // namespace lodestone
