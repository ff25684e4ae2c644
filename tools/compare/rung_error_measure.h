// Measures how far a shape's bodies are from the truth on each rung (signature/rung_errors.h): single drops,
// scored, and where each is after a second.
#pragma once

#include "signature/rung_errors.h"
#include "tools/compare/drop_comparison.h"

namespace lodestone {

struct RungErrorMeasurement {
  RungErrors errors;
  double floor = 0.0;  ///< score of truth against truth
  /// Of the full level at the truth's step: the least that a level that meets planes in its own way can have.
  double floor_drift = 0.0;
};

/// At 1/60 s, whatever steps and methods `settings` has.
RungErrorMeasurement measure_rung_errors(const DropJob& job, DropComparisonSettings settings);

}  // namespace lodestone
