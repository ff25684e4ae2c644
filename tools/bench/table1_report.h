// Table 1 as text for people, JSON for programs, and a CSV file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "tools/bench/table1.h"

namespace lodestone {

/// Ours beside the paper's; under it, why rows were left out.
std::string text_of(std::span<const Table1Row> rows);
nlohmann::ordered_json json_of(const Table1Row& row);
nlohmann::ordered_json json_of(std::span<const Table1Row> rows);

/// What rows move beside what the machine could.
std::string roofline_text_of(const Bandwidth& bandwidth, std::span<const Table1Row> rows);
nlohmann::ordered_json json_of(const Bandwidth& bandwidth);

}  // namespace lodestone
