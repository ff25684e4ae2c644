// What the reports of comparisons have in common: the columns that say which method it is, and those left
// out.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/compare/comparison.h"

namespace lodestone {

/// Method, model, step and substeps.
std::vector<std::string> cells_of(const MethodAtStep& row);
nlohmann::ordered_json json_of(const MethodAtStep& row);

/// A line for each method that was left out, once for all steps.
template <class Row>
std::string left_out_of(const std::string& shape, const std::vector<Row>& rows) {
  std::string left_out;
  for (const Row& row : rows) {
    const std::string line = fmt::format("{} left out: {} {}\n", row.method, shape, row.reason);
    if (!row.reason.empty() && left_out.find(line) == std::string::npos) left_out += line;
  }
  return left_out;
}

}  // namespace lodestone
