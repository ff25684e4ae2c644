// Drops harder than the usual ones, one condition changed at a time.
#pragma once

#include <string>
#include <vector>

#include "tools/compare/drop_method.h"

namespace lodestone {

/// A drop under a name.
struct DropCase {
  std::string name;
  DropJob job;
};

/// "usual", then as `restitution=0.9`: other restitutions (0 … .9), frictions (0 … 1), speeds, slopes (to 40
/// degrees) and sizes (1 mm … 10 m, lengths × λ and times × √λ).
std::vector<std::string> condition_names();

/// `usual` itself, then a copy under each of the other conditions; in the order of condition_names().
std::vector<DropCase> make_condition_cases(const DropJob& usual);

}  // namespace lodestone
