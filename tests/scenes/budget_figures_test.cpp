#include "scenes/budget_figures.h"

#include <gtest/gtest.h>

#include <vector>

namespace lodestone {
namespace {

constexpr std::size_t kFull = std::size_t(Rung::full), kSupport = std::size_t(Rung::support),
                      kTables = std::size_t(Rung::tables);

// Twenty steps: the first nine far over any budget, then 1, 2, … 11 ms, foretold as half a millisecond more.
struct TwentySteps {
  TwentySteps() {
    for (int i = 0; i < 20; ++i) {
      const double ms = i < 9 ? 100.0 : i - 8;
      step_ms.push_back(ms);
      StepReport report;
      report.full = i, report.support = 2 * i, report.tables = i < 9 ? 1000 : 7;
      report.predicted_ms = ms + 0.5, report.measured_ms = ms;
      report.cost[kSupport] = {.predicted_ms = 1.0, .measured_ms = 2.0, .work = 30.0};
      report.cost[kFull].work = 12.0;
      reports.push_back(report);
    }
  }
  std::vector<StepReport> reports;
  std::vector<double> step_ms;
};

TEST(BudgetFigures, CountFromTheTenthStepOn) {
  const TwentySteps run;
  const auto figures = find_budget_figures({.policy = BudgetPolicy{8.0}}, run.reports, run.step_ms);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->budget_ms, 8.0);
  EXPECT_EQ(figures->budget_work, std::nullopt);
  EXPECT_EQ(figures->steps, 11);
  EXPECT_EQ(figures->over, 3);  // 9, 10 and 11 ms; 8 is within
  EXPECT_EQ(figures->step_ms.p50, 6);
  EXPECT_EQ(figures->step_ms.max, 11);
  EXPECT_EQ(figures->mean_bodies[kFull], 14);
  EXPECT_EQ(figures->mean_bodies[kSupport], 28);
  EXPECT_EQ(figures->mean_bodies[kTables], 7);
  EXPECT_EQ(figures->mean_cost[kSupport].measured_ms, 2.0);
  EXPECT_EQ(figures->mean_work, 42.0);
  EXPECT_EQ(figures->mean_predicted_ms, 6.5);
  EXPECT_EQ(figures->mean_error_ms, 0.5);
}

TEST(BudgetFigures, WorkIsNotTime) {
  const TwentySteps run;
  const auto figures = find_budget_figures({.policy = WorkPolicy{40.0}}, run.reports, run.step_ms);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->budget_work, 40.0);
  EXPECT_EQ(figures->over, std::nullopt);
  EXPECT_EQ(figures->step_ms.max, 11);
}

TEST(BudgetFigures, NoneWithoutABudgetAndNoStepsInAShortRun) {
  const TwentySteps run;
  EXPECT_FALSE(find_budget_figures({.policy = DistancePolicy{}}, run.reports, run.step_ms));
  const auto figures = find_budget_figures({.policy = BudgetPolicy{8.0}}, std::span(run.reports).first(9),
                                           std::span(run.step_ms).first(9));
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->steps, 0);
  EXPECT_EQ(figures->over, 0);
}

}  // namespace
}  // namespace lodestone
