#include "tools/compare/comparison.h"

#include <fmt/format.h>

namespace lodestone {

MethodAtStep at_step(const Method& method, double dt_s) {
  return {.method = method.name,
          .model = method.model(),
          .dt_s = dt_s,
          .substeps = method.substeps(),
          .reason = method.left_out};
}

std::string name_of(const MethodAtStep& row) {
  return fmt::format("{} {} at {:.4g} s", row.method, row.model, row.dt_s);
}

}  // namespace lodestone
