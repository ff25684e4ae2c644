// Comparisons of several drops, one after the other: of many shapes, or of one under many conditions.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "signature/measure/measurement.h"
#include "tools/compare/drop_comparison.h"

namespace lodestone {

/// A drop under a name.
struct DropCase {
  std::string name;
  DropJob job;
  int index = 0;  ///< in the whole series, of which these may be a share
};

/// "usual", then as `restitution=0.9`: other restitutions (0 … .9), frictions (0 … 1), speeds, slopes (to 40
/// degrees), sizes (1 mm … 10 m, lengths × λ and times × √λ) and grounds.
std::vector<std::string> condition_names();

/// `usual` itself, then a copy under each of the other conditions; in the order of condition_names().
std::vector<DropCase> make_condition_cases(const DropJob& usual);

/// Every pair of six restitutions (0 … .9) and five frictions (0 … 1), as `restitution=0.4 friction=0.5`.
std::vector<DropCase> make_material_cases(const DropJob& usual);

/// Leaves those whose index is in the share; the first one, too, where `keep_first`.
void keep_share(std::vector<DropCase>& cases, const Share& share, bool keep_first);

/// The comparison of each case, in order, all with these settings.
std::vector<DropComparison> compare_series(std::span<const DropCase> cases,
                                           const DropComparisonSettings& settings);

/// The rows of all comparisons below each other, the noise floor's beside the score. `what` heads the column
/// of the cases' names. Where `over_first`, each score is also given over that of the same method and step in
/// the first case.
std::string text_of(const std::string& what, std::span<const DropCase> cases,
                    std::span<const DropComparison> series, bool over_first);

/// {"trials", "rows"}: rows as those of a single comparison, each with its case's name under `key`, its index
/// as "case", "restitution", "friction" and, where `over_first`, "score_over_first".
nlohmann::ordered_json json_of(const std::string& key, std::span<const DropCase> cases,
                               std::span<const DropComparison> series, bool over_first);

}  // namespace lodestone
