// Comparisons of several drops, one after the other: of many shapes, or of one under many conditions.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/compare/drop_comparison.h"
#include "tools/compare/drop_conditions.h"

namespace lodestone {

/// The comparison of each case, in order, all with these settings.
std::vector<DropComparison> compare_series(std::span<const DropCase> cases,
                                           const DropComparisonSettings& settings);

/// The rows of all comparisons below each other, the noise floor's beside the score. `what` heads the column
/// of the cases' names. Where `over_first`, each score is also given over that of the same method and step in
/// the first case.
std::string text_of(const std::string& what, std::span<const DropCase> cases,
                    std::span<const DropComparison> series, bool over_first);

/// {"trials", "rows"}: rows as those of a single comparison, each with its case's name under `key` and, where
/// `over_first`, "score_over_first".
nlohmann::ordered_json json_of(const std::string& key, std::span<const DropCase> cases,
                               std::span<const DropComparison> series, bool over_first);

}  // namespace lodestone
