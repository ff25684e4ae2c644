#include "scenes/budget_figures.h"

#include <cmath>

namespace lodestone {
namespace {

int bodies_at(const StepReport& report, Rung rung) {
  if (rung == Rung::full) return report.full;
  return rung == Rung::support ? report.support : report.tables;
}

BudgetFigures divide(BudgetFigures sums) {
  const double count = sums.steps;
  for (double& bodies : sums.mean_bodies) bodies /= count;
  for (RungCost& cost : sums.mean_cost)
    cost.predicted_ms /= count, cost.measured_ms /= count, cost.work /= count;
  for (double* sum : {&sums.mean_predicted_ms, &sums.mean_measured_ms, &sums.mean_error_ms}) *sum /= count;
  if (sums.mean_error_pixels) *sums.mean_error_pixels /= count;
  for (const RungCost& cost : sums.mean_cost) sums.mean_work += cost.work;
  return sums;
}

}  // namespace

BudgetTally::BudgetTally(const PolicySettings& policy) {
  BudgetFigures figures;
  if (const auto* time = std::get_if<BudgetPolicy>(&policy.policy))
    figures.budget_ms = time->budget_ms;
  else if (const auto* work = std::get_if<WorkPolicy>(&policy.policy))
    figures.budget_work = work->budget_work;
  else if (const auto* error = std::get_if<ErrorBudgetPolicy>(&policy.policy))
    error->budget_work ? figures.budget_work = error->budget_work : figures.budget_ms = error->budget_ms;
  else
    return;
  if (figures.budget_ms) figures.over = 0;
  if (std::holds_alternative<ErrorBudgetPolicy>(policy.policy)) figures.mean_error_pixels = 0.0;
  sums_ = figures;
}

void BudgetTally::add(const StepReport& report, double step_ms) {
  if (!sums_ || ++steps_ < kFirstBudgetStep) return;
  ++sums_->steps;
  times_.add(step_ms);
  if (sums_->budget_ms && step_ms > *sums_->budget_ms) ++*sums_->over;
  for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
    const std::size_t i = std::size_t(rung);
    sums_->mean_bodies[i] += bodies_at(report, rung);
    RungCost& cost = sums_->mean_cost[i];
    cost.predicted_ms += report.cost[i].predicted_ms, cost.measured_ms += report.cost[i].measured_ms,
        cost.work += report.cost[i].work;
  }
  sums_->mean_predicted_ms += report.predicted_ms;
  sums_->mean_measured_ms += report.measured_ms;
  sums_->mean_error_ms += std::abs(report.predicted_ms - report.measured_ms);
  if (sums_->mean_error_pixels) *sums_->mean_error_pixels += report.predicted_error_pixels;
}

std::optional<BudgetFigures> BudgetTally::figures() const {
  if (!sums_ || sums_->steps == 0) return sums_;
  BudgetFigures figures = divide(*sums_);
  figures.step_ms = times_.summary();
  return figures;
}

std::optional<BudgetFigures> find_budget_figures(const PolicySettings& policy,
                                                 std::span<const StepReport> reports,
                                                 std::span<const double> step_ms) {
  BudgetTally tally(policy);
  for (std::size_t i = 0; i < reports.size(); ++i) tally.add(reports[i], step_ms[i]);
  return tally.figures();
}

}  // namespace lodestone
