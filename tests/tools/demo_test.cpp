// `demo`: a scene under three budgets, and what the report says of them.
#include "tools/demo/demo.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodestone {
namespace {

Scene two_crates() {
  Scene scene;
  scene.ground = {GroundPlane{}};
  for (const double x : {0.0, 2.0}) {
    SceneBody body;
    body.definition.shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.2, 0.2})));
    body.definition.state.position = {x, 0, 0.5};
    body.definition.level = LevelChoice::full;  // needs no signature
    scene.bodies.push_back(body);
  }
  scene.default_steps = 25;
  return scene;
}

TEST(DemoBudgets, AreThreeOfOneScene) {
  RunSettings settings;
  settings.out = "/nowhere";  // of the main scene's run alone
  settings.budget_work = 100.0;
  settings.full_within_m = 3.0;  // likewise
  const auto budgets = run_budgets(two_crates(), settings, {});
  ASSERT_EQ(budgets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const BudgetFigures& figures = budgets[i].budget.value();
    EXPECT_EQ(figures.budget_ms, kDemoBudgets[i]);
    EXPECT_EQ(figures.steps, 16);
    EXPECT_EQ(figures.mean_bodies[std::size_t(Rung::full)], 2.0);
    EXPECT_EQ(budgets[i].step_processor_ms.size(), 25u);
    EXPECT_EQ(summarize(budgets[i].step_processor_ms).max, budgets[i].processor_ms.max);
  }
}

TEST(DemoReport, ShowsBudgetsAndThePictureWhereThereAreAny) {
  DemoResult result;
  result.rows.push_back({.name = "full",
                         .whole_ms = std::nullopt,
                         .processor_ms = std::nullopt,
                         .busy_ms = {.p50 = 1.0},
                         .most_full = 2});
  result.mixed.reports.resize(1);
  result.drop.shape = two_crates().bodies[0].definition.shape;
  EXPECT_EQ(text_of(result).find("What a budget buys"), std::string::npos);
  EXPECT_EQ(text_of(result).find("in the picture"), std::string::npos);
  result.budget_scene = "heap.yaml";
  result.budgets.resize(1);
  result.budgets[0].budget = BudgetFigures{.budget_ms = 4.0,
                                           .budget_work = std::nullopt,
                                           .steps = 591,
                                           .over = 7,
                                           .step_ms = {.p50 = 1.25, .p99 = 3.5, .max = 4.75},
                                           .mean_bodies = {70.0, 20.0, 10.0}};
  result.mixed.in_picture = {.min_full = 8, .mean_full = 9.5};
  const std::string text = text_of(result);
  EXPECT_NE(text.find("What a budget buys: heap.yaml, processor time of 591 steps from step 10 on"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("at least 8 full bodies are in the picture of the scene's viewpoint (60 deg high, 16 : "
                      "9), on average 9.5"),
            std::string::npos)
      << text;
  const auto json = json_of(result);
  EXPECT_EQ(json["budgets"][0]["over"], 7);
  EXPECT_EQ(json["budgets"][0]["mean_full"], 10.0);
  EXPECT_EQ(json["mixed"]["in_picture"]["min_full"], 8);
}

TEST(DemoReport, TheBusyWindowEndsWithTheRun) {
  std::vector<StepReport> reports(20);
  reports[5].contacts = 3;
  BusyWindow busy = find_busy_window(reports);
  EXPECT_EQ(std::pair(busy.first, busy.steps), std::pair(5, 8));
  reports[18].contacts = 4;
  busy = find_busy_window(reports);
  EXPECT_EQ(std::pair(busy.first, busy.steps), std::pair(12, 8));
  busy = find_busy_window(std::span(reports).first(3));
  EXPECT_EQ(std::pair(busy.first, busy.steps), std::pair(0, 3));
}

// Of three steps none is one that a budget is counted from.
TEST(DemoReport, OfABudgetThatNoStepCountsForThereAreDashes) {
  DemoResult result;
  result.drop.shape = two_crates().bodies[0].definition.shape;
  Scene scene = two_crates();
  scene.default_steps = 3;
  result.budgets = run_budgets(scene, {}, {});
  const std::string text = text_of(result);
  const std::size_t row = text.find("\n        4 ");
  ASSERT_NE(row, std::string::npos) << text;
  EXPECT_EQ(std::ranges::count(text.substr(row + 1, text.find('\n', row + 1) - row), '-'), 7) << text;
}

TEST(DemoReport, HasARowForEachStepOfEachRun) {
  DemoResult result;
  result.scene = "scenes/bunnies.yaml", result.budget_scene = "heap.yaml", result.dt_s = 0.01;
  result.mixed.reports.resize(2);
  StepReport& first = result.mixed.reports[0];
  first.full = 1, first.asleep = 3, first.support = 2, first.tables = 4;
  result.mixed.step_processor_ms = {0.5, 0.25};
  result.budgets.resize(1);
  result.budgets[0].reports.resize(1);
  result.budgets[0].reports[0].dt_s = 0.02;
  result.budgets[0].step_processor_ms = {0.125};
  result.budgets[0].budget = BudgetFigures{.budget_ms = 4.0, .budget_work = std::nullopt, .over = 0};
  const auto rows = step_rows_of(result);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0], (nlohmann::ordered_json{{"scene", "bunnies.yaml"},
                                             {"budget_ms", nullptr},
                                             {"dt_s", 0.01},
                                             {"step", 1},
                                             {"full", 1},
                                             {"support", 2},
                                             {"tables", 4},
                                             {"asleep", 3},
                                             {"processor_ms", 0.5}}));
  EXPECT_EQ(rows[1]["step"], 2);
  EXPECT_EQ(rows[2]["budget_ms"], 4.0);
  EXPECT_EQ(rows[2]["dt_s"], 0.02);
}

}  // namespace
}  // namespace lodestone
