// The shares of a series of comparisons, which may be measured on several machines: joined, and shown.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace lodestone {

/// One object out of those that `compare … --shard I/N --json` printed, every I of one N, in any order: the
/// rows of all cases in order. Throws InputError, with the part's name and what was found and expected, where
/// one is missing, there twice, ended early, or of another series.
nlohmann::ordered_json merge_series(std::span<const nlohmann::ordered_json> parts,
                                    std::span<const std::string> names);

/// Of `compare materials`: for each method a table of scores, restitutions down and frictions across.
std::string material_tables_of(const nlohmann::ordered_json& series);

}  // namespace lodestone
