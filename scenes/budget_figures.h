// How a run kept to its budget, and how well its cost was foretold.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "lod/policy.h"
#include "lod/step_report.h"
#include "scenes/time_summary.h"

namespace lodestone {

/// Counted from this step on, 1 being the first: in those before, arrays grow and meshes are built.
inline constexpr int kFirstBudgetStep = 10;

/// Of whole steps from the tenth on, in processor time of the thread that calls them; means are over these
/// steps.
struct BudgetFigures {
  std::optional<double> budget_ms, budget_work;  ///< one of them
  int steps = 0;                                 ///< 0: the run was too short, and all that follows is 0
  std::optional<int> over;  ///< steps longer than budget_ms; none for work, which no clock measures
  TimeSummary step_ms = {};
  std::array<double, kRungs> mean_bodies{};            ///< at the end of a step, by Rung
  std::array<RungCost, kRungs> mean_cost{};            ///< by Rung
  double mean_predicted_ms = 0, mean_measured_ms = 0;  ///< of a whole step, by its report
  double mean_error_ms = 0;                            ///< |predicted − measured|
  double mean_work = 0;                                ///< units of all rungs
  /// Predicted of the scene (StepReport::predicted_error_pixels), under an error budget.
  std::optional<double> mean_error_pixels = {};
};

/// Takes the steps of a run one by one.
class BudgetTally {
 public:
  explicit BudgetTally(const PolicySettings& policy);
  void add(const StepReport& report, double step_ms);  ///< `step_ms`: its processor time
  std::optional<BudgetFigures> figures() const;        ///< so far; none for a policy without a budget

 private:
  std::optional<BudgetFigures> sums_;  // its means not yet divided
  int steps_ = 0;                      // those before the tenth, too
  TimeTally times_;
};

/// `step_ms`: processor time of each of `reports`. None for a policy without a budget.
std::optional<BudgetFigures> find_budget_figures(const PolicySettings& policy,
                                                 std::span<const StepReport> reports,
                                                 std::span<const double> step_ms);

}  // namespace lodestone
