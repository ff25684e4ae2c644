#include "scenes/budget_figures.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

int bodies_at(const StepReport& report, Rung rung) {
  if (rung == Rung::full) return report.full;
  return rung == Rung::support ? report.support : report.tables;
}

template <class Value>
double mean_over(std::span<const StepReport> reports, const Value& value) {
  double sum = 0.0;
  for (const StepReport& report : reports) sum += double(value(report));
  return sum / double(reports.size());
}

RungCost mean_cost(std::span<const StepReport> reports, std::size_t rung) {
  return {.predicted_ms = mean_over(reports, [&](const StepReport& r) { return r.cost[rung].predicted_ms; }),
          .measured_ms = mean_over(reports, [&](const StepReport& r) { return r.cost[rung].measured_ms; }),
          .work = mean_over(reports, [&](const StepReport& r) { return r.cost[rung].work; })};
}

}  // namespace

std::optional<BudgetFigures> find_budget_figures(const PolicySettings& policy, std::span<const StepReport> reports, std::span<const double> step_ms) {
  BudgetFigures figures;
  if (const auto* time = std::get_if<BudgetPolicy>(&policy.policy)) figures.budget_ms = time->budget_ms;
  else if (const auto* work = std::get_if<WorkPolicy>(&policy.policy)) figures.budget_work = work->budget_work;
  else if (const auto* error = std::get_if<ErrorBudgetPolicy>(&policy.policy)) error->budget_work ? figures.budget_work = error->budget_work : figures.budget_ms = error->budget_ms;
  else return std::nullopt;
  if (figures.budget_ms) figures.over = 0;
  if (std::holds_alternative<ErrorBudgetPolicy>(policy.policy)) figures.mean_error_pixels = 0.0;
  const std::size_t before = kFirstBudgetStep - 1;
  if (reports.size() <= before) return figures;
  reports = reports.subspan(before), step_ms = step_ms.subspan(before);
  figures.steps = int(reports.size());
  figures.step_ms = summarize(step_ms);
  if (figures.budget_ms) figures.over = int(std::ranges::count_if(step_ms, [&](double ms) { return ms > *figures.budget_ms; }));
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
    const std::size_t i = std::size_t(rung);
    figures.mean_bodies[i] = mean_over(reports, [&](const StepReport& r) { return bodies_at(r, rung); });
    figures.mean_cost[i] = mean_cost(reports, i);
    figures.mean_work += figures.mean_cost[i].work;
  }
  figures.mean_predicted_ms = mean_over(reports, [](const StepReport& r) { return r.predicted_ms; });
  figures.mean_measured_ms = mean_over(reports, [](const StepReport& r) { return r.measured_ms; });
  if (figures.mean_error_pixels) figures.mean_error_pixels = mean_over(reports, [](const StepReport& r) { return r.predicted_error_pixels; });
  figures.mean_error_ms = mean_over(reports, [](const StepReport& r) { return std::abs(r.predicted_ms - r.measured_ms); });
  return figures;
}

}  // namespace lodestone
