#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "scenes/camera.h"
#include "tools/compare/drop_report.h"
#include "tools/demo/demo.h"
#include "tools/run_report.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string text_of(std::optional<double> ms) { return ms ? text_of_ms(*ms) : "-"; }

std::optional<double> part_of(const std::optional<TimeSummary>& ms, double TimeSummary::*part) {
  if (!ms) return std::nullopt;
  return (*ms).*part;
}

// Full comes last.
double times_faster(const DemoResult& result, const DemoRow& row) {
  return result.rows.back().busy_ms.p50 / row.busy_ms.p50;
}

std::string text_of_times(const DemoResult& result) {
  TextTable table({"level", "median ms", "99 % ms", "99 % processor ms", "busy median ms", "busy, full/this",
                   "most at full"});
  for (const DemoRow& row : result.rows)
    table.add_row({row.name, text_of(part_of(row.whole_ms, &TimeSummary::p50)),
                   text_of(part_of(row.whole_ms, &TimeSummary::p99)),
                   text_of(part_of(row.processor_ms, &TimeSummary::p99)), text_of(row.busy_ms.p50),
                   fmt::format("{:.3g}", times_faster(result, row)), fmt::format("{}", row.most_full)});
  return table.text();
}

// Dashes of a run that was too short for any step to count.
std::string text_of_budgets(std::span<const RunResult> runs) {
  TextTable table({"budget ms", "median ms", "99 % ms", "longest ms", "steps over", "mean full",
                   "mean support", "mean tables"});
  for (const RunResult& run : runs) {
    const BudgetFigures& budget = run.budget.value();
    if (budget.steps == 0) {
      table.add_row({fmt::format("{:g}", *budget.budget_ms), "-", "-", "-", "-", "-", "-", "-"});
      continue;
    }
    const auto bodies = [&](Rung rung) {
      return fmt::format("{:.1f}", budget.mean_bodies[std::size_t(rung)]);
    };
    table.add_row({fmt::format("{:g}", *budget.budget_ms), text_of(budget.step_ms.p50),
                   text_of(budget.step_ms.p99), text_of(budget.step_ms.max), fmt::format("{}", *budget.over),
                   bodies(Rung::full), bodies(Rung::support), bodies(Rung::tables)});
  }
  return table.text();
}

std::string text_of_failed_checks(const RunResult& run) {
  std::string text;
  for (const CheckResult& check : run.checks)
    if (!check.pass)
      text += fmt::format("FAILED in the mixed run: {} {:.4g}, bound {:.4g}\n", check.name, check.value,
                          check.bound);
  return text;
}

ordered_json finite_or_null(std::optional<double> value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

ordered_json json_of(const DemoRow& row) {
  return {{"level", row.name},
          {"p50_ms", finite_or_null(part_of(row.whole_ms, &TimeSummary::p50))},
          {"p99_ms", finite_or_null(part_of(row.whole_ms, &TimeSummary::p99))},
          {"p99_processor_ms", finite_or_null(part_of(row.processor_ms, &TimeSummary::p99))},
          {"busy_p50_ms", row.busy_ms.p50},
          {"most_full", row.most_full}};
}

void add_step_rows(ordered_json& rows, const std::string& scene, const RunResult& run, double dt_s) {
  const ordered_json budget_ms = run.budget ? finite_or_null(run.budget->budget_ms) : ordered_json(nullptr);
  for (std::size_t i = 0; i < run.reports.size(); ++i) {
    const StepReport& report = run.reports[i];
    rows.push_back({{"scene", std::filesystem::path(scene).filename().string()},
                    {"budget_ms", budget_ms},
                    {"dt_s", rounded(dt_s, 1e6)},
                    {"step", i + 1},
                    {"full", report.full},
                    {"support", report.support},
                    {"tables", report.tables},
                    {"asleep", report.asleep},
                    {"processor_ms", rounded(run.step_processor_ms[i], 1e4)}});
  }
}

}  // namespace

std::string text_of(const DemoResult& result) {
  std::string text;
  text += fmt::format("{} bodies, {} steps of {:.4g} ms\n\n", result.mixed.bodies, result.mixed.steps,
                      1e3 * result.dt_s);
  text += "What a step costs\n\n" + text_of_times(result);
  text += fmt::format("\nbusy: steps {} to {}, those of the most contacts; full is run over these alone\n\n",
                      result.busy.first + 1, result.busy.first + result.busy.steps);
  if (const auto& picture = result.mixed.in_picture)
    text += fmt::format(
        "In the mixed run, from half a second on, at least {} full bodies are in the picture of the scene's "
        "viewpoint ({:.0f} deg high, 16 : 9), on average {:.1f}\n\n",
        picture->min_full, kFieldOfView * 180.0 / std::numbers::pi, picture->mean_full);
  text += "What that costs in accuracy\n\n" + text_of(result.drop, result.errors) + '\n';
  if (!result.budgets.empty())
    text += fmt::format("What a budget buys: {}, processor time of {} steps from step {} on\n\n{}\n",
                        result.budget_scene, result.budgets.front().budget.value().steps, kFirstBudgetStep,
                        text_of_budgets(result.budgets));
  text += text_of_failed_checks(result.mixed);
  if (!result.mixed.trajectory.empty())
    text += fmt::format("The mixed run is in {}, for any viewer of glTF\n", result.mixed.trajectory.string());
  return text;
}

ordered_json json_of(const DemoResult& result) {
  ordered_json json;
  json["busy_step"] = result.busy.first;
  json["busy_steps"] = result.busy.steps;
  json["levels"] = level_rows_of(result);
  json["mixed"] = json_of(result.mixed);
  json["errors"] = json_of(result.errors);
  json["budgets"] = ordered_json::array();
  for (const RunResult& run : result.budgets) json["budgets"].push_back(json_of(run.budget.value()));
  return json;
}

ordered_json level_rows_of(const DemoResult& result) {
  ordered_json rows = ordered_json::array();
  for (const DemoRow& row : result.rows) rows.push_back(json_of(row));
  return rows;
}

ordered_json step_rows_of(const DemoResult& result) {
  ordered_json rows = ordered_json::array();
  add_step_rows(rows, result.scene, result.mixed, result.dt_s);
  for (const RunResult& run : result.budgets)
    add_step_rows(rows, result.budget_scene, run, run.reports.front().dt_s);
  return rows;
}

}  // namespace lodestone
