// Stage 5 of a step: what it did, in numbers, and under a budget what it cost.
#pragma once

#include <optional>

#include "lod/manager/choose.h"
#include "lod/manager/cost_model.h"
#include "lod/manager/levels.h"
#include "lod/step_report.h"

namespace lodestone {

/// Counts of the bodies at the end of the step.
void report_bodies(const Levels& levels, StepReport& report);

/// What the step was predicted to cost and what it cost, measured but for `report` itself; the model learns
/// from it where the budget is in ms.
void report_cost(const Levels& levels, const StepCounts& counts, const StepMeasurement& measured,
                 std::optional<double> budget_ms, CostModel& costs, StepReport& report);

}  // namespace lodestone
