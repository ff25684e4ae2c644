#include "tools/compare/rung_error_measure.h"

#include <fmt/format.h>

#include "reference/error.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

/// Over the shape's size: drops of the same starts, one by one.
double mean_drift(const DropJob& job, std::span<const DropObservation> truth,
                  std::span<const DropObservation> drops) {
  double sum = 0.0;
  for (std::size_t i = 0; i < drops.size(); ++i)
    sum += (drops[i].after_a_second - truth[i].after_a_second).norm();
  return sum / double(drops.size()) / job.shape->size;
}

RungError error_of(const DropJob& job, const DropComparison& comparison, const std::string& method,
                   const std::string& model) {
  for (const DropRow& row : comparison.rows) {
    if (row.method != method || row.model != model) continue;
    if (!row.score)
      throw InputError(
          fmt::format("errors of the rungs: found no {} ({}), expected drops by it", method, row.reason));
    return {row.score->value.score, mean_drift(job, comparison.truth_b, row.drops)};
  }
  check_that(false, "every rung was compared");
  return {};
}

}  // namespace

RungErrorMeasurement measure_rung_errors(const DropJob& job, DropComparisonSettings settings) {
  settings.dt_s = {kObservationStep};
  settings.methods = {"full", "full_34", "statistical"};
  settings.costs = false;
  const DropComparison comparison = compare_drops(job, settings);
  throw_if_interrupted();  // a part of the rungs is no measure of them
  RungErrorMeasurement measured{.errors = {}, .floor = comparison.floor.value.score};
  measured.errors = {.tables = error_of(job, comparison, "statistical", "tables"),
                     .support = error_of(job, comparison, "statistical", "support"),
                     .full = error_of(job, comparison, "full", ""),
                     .drops = std::uint32_t(comparison.trials)};
  measured.floor_drift = error_of(job, comparison, "full_34", "").drift;
  return measured;
}

}  // namespace lodestone
