// The broad phase's figures as text for people and JSON for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "tools/bench/broad_phase_bench.h"

namespace lodestone {

/// Under the table, where pairs differed.
std::string text_of(std::span<const BroadPhaseRow> rows);
nlohmann::ordered_json json_of(const BroadPhaseRow& row);
nlohmann::ordered_json json_of(std::span<const BroadPhaseRow> rows);

}  // namespace lodestone
