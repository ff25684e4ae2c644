// One scene at every level: what a step costs, and what the speed costs in accuracy.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/runner.h"
#include "tools/compare/drop_comparison.h"

namespace lodestone {

/// How one level copes with the scene.
struct DemoRow {
  std::string name;
  std::optional<TimeSummary> whole_ms;      ///< none for full, which is run over the busy window only
  std::optional<TimeSummary> processor_ms;  ///< the same in processor time
  TimeSummary busy_ms;                      ///< over the busy window
  int most_full = 0;                        ///< bodies at the full level at once
};

/// Steps of a run.
struct BusyWindow {
  int first = 0;  ///< from 0
  int steps = 0;
};
/// The busiest eight, or all where there are fewer: from the step with the most contacts on, if so many
/// follow it.
BusyWindow find_busy_window(std::span<const StepReport> reports);

struct DemoResult {
  std::string scene;  ///< its file
  double dt_s = 0.0;
  BusyWindow busy;
  std::vector<DemoRow> rows;
  RunResult mixed;  ///< the run whose trajectory is written
  DropJob drop;     ///< the scene's first shape, dropped alone
  DropComparison errors;
  std::string budget_scene;        ///< run under each of kDemoBudgets; empty: none
  std::vector<RunResult> budgets;  ///< with their figures
};

inline constexpr std::array kDemoBudgets = {4.0, 8.0, 16.0};  ///< ms

/// Runs `scene` mixed (as its policy says), statistically with each model, and in full from where the
/// statistical run has the most contacts on; then compares `trials` single drops of its first body's shape
/// with the truth.
DemoResult run_demo(const Scene& scene, const RunSettings& settings, int trials, const Progress& progress);

/// Runs `scene` under each of kDemoBudgets; the results have figures of it.
std::vector<RunResult> run_budgets(const Scene& scene, RunSettings settings, const Progress& progress);

std::string text_of(const DemoResult& result);
nlohmann::ordered_json json_of(const DemoResult& result);

/// What every step of the mixed run and of those under a budget did, as flat rows: bodies on each rung and
/// asleep at its end, and its processor time.
nlohmann::ordered_json step_rows_of(const DemoResult& result);
/// What a step costs at each level, as flat rows.
nlohmann::ordered_json level_rows_of(const DemoResult& result);

}  // namespace lodestone
