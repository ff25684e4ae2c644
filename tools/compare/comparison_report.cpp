#include "tools/compare/comparison_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/results.h"

namespace lodestone {
namespace {

// 1/60 where that is what it is.
std::string text_of_step(double dt_s) {
  const double per_second = 1.0 / dt_s;
  if (std::abs(per_second - std::round(per_second)) < 1e-3 * per_second)
    return fmt::format("1/{:.0f}", per_second);
  return fmt::format("{:.4g}", dt_s);
}

}  // namespace

std::vector<std::string> cells_of(const MethodAtStep& row) {
  return {row.method, row.model, text_of_step(row.dt_s), fmt::format("{}", row.substeps)};
}

nlohmann::ordered_json json_of(const MethodAtStep& row) {
  return {
      {"method", row.method}, {"model", or_null(row.model)}, {"dt_s", row.dt_s}, {"substeps", row.substeps}};
}

}  // namespace lodestone
