#include "tools/compare/drop_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "reference/mass_bounds.h"
#include "tests/tools/methods/box_job.h"

namespace lodestone::drop_series_test {
namespace {

using testing::box_job;

DropComparisonSettings few_drops() {
  DropComparisonSettings settings;
  settings.trials = 12;
  settings.methods = {"full_1"};
  settings.costs = false;
  return settings;
}

TEST(DropConditions, ChangeOneThingEach) {
  const DropJob usual = box_job();
  const auto cases = make_condition_cases(usual);
  const auto names = condition_names();
  ASSERT_EQ(cases.size(), names.size());
  std::set<std::string> seen;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const DropJob& job = cases[i].job;
    EXPECT_EQ(cases[i].name, names[i]);
    EXPECT_TRUE(seen.insert(names[i]).second) << names[i];
    const int changes = (job.shape != usual.shape) +
                        (job.material.restitution != usual.material.restitution) +
                        (job.material.friction != usual.material.friction) + (job.conditions.slope != 0.0) +
                        (job.conditions.speed_scale != 1.0) + (job.ground != DropGround::plane);
    EXPECT_EQ(changes, i == 0 ? 0 : 1) << names[i];
  }
  EXPECT_EQ(cases[0].name, "usual");
}

TEST(DropConditions, ASizeIsThatOfTheLongestSide) {
  const auto cases = make_condition_cases(box_job());
  const auto small = std::ranges::find(cases, "size_m=0.001", &DropCase::name);
  ASSERT_NE(small, cases.end());
  EXPECT_NEAR(small->job.shape->size, 0.001, 1e-15);
}

// A box of a millimetre of the usual density weighs less than any rung takes.
TEST(DropConditions, TheSmallestBodiesAreAsDenseAsABodyMustBe) {
  for (const DropCase& one : make_condition_cases(box_job()))
    EXPECT_GE(one.job.material.density * one.job.shape->volume, kLeastMass) << one.name;
}

TEST(DropSeries, RowsBearTheNamesOfTheirCases) {
  auto cases = make_condition_cases(box_job());
  cases.resize(2);
  const auto series = compare_series(cases, few_drops());
  const auto json = json_of("condition", cases, series, true);
  EXPECT_EQ(json["trials"], 12);
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][0]["condition"], "usual");
  EXPECT_EQ(json["rows"][1]["condition"], "restitution=0");
  EXPECT_EQ(json["rows"][0]["score_over_first"], 1.0);
  EXPECT_DOUBLE_EQ(json["rows"][1]["score_over_first"].get<double>(),
                   json["rows"][1]["score"].get<double>() / json["rows"][0]["score"].get<double>());
  for (const char* key :
       {"method", "model", "dt_s", "substeps", "score", "floor", "parts", "tv", "table_extrapolations"})
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  EXPECT_TRUE(json["rows"][0]["ns_per_body_step"].is_null());
  EXPECT_NE(text_of("condition", cases, series, true).find("restitution=0"), std::string::npos);
}

// What the usual case does not tell apart from the truth is no measure for the others.
TEST(DropSeries, NothingIsOverAScoreOfZeroOrOneThatIsLeftOut) {
  const std::vector<DropCase> cases = {{"usual", box_job(), 0}, {"restitution=0", box_job(), 1}};
  std::vector<DropComparison> series(2);
  for (DropComparison& one : series) one.rows = {DropRow{}, DropRow{}};
  for (DropComparison& one : series) one.rows[0].score.emplace();
  series[1].rows[0].score->value.score = 0.5, series[1].rows[1].score.emplace();
  const auto json = json_of("condition", cases, series, true);
  for (const auto& row : json["rows"]) EXPECT_TRUE(row["score_over_first"].is_null()) << row;
  const std::string text = text_of("condition", cases, series, true);
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
}

// The truth of small bodies is as fine in their own time.
TEST(DropSeries, TheTruthOfASmallBodyTakesShorterSteps) {
  const DropJob usual = box_job();
  EXPECT_EQ(make_truth(usual).substeps(), 34);
  EXPECT_EQ(make_truth({.shape = std::make_shared<const Shape>(scale_shape(*usual.shape, 0.005)),
                        .conditions = {},
                        .material = {}})
                .substeps(),
            340);
  EXPECT_EQ(make_truth({.shape = std::make_shared<const Shape>(scale_shape(*usual.shape, 25.0)),
                        .conditions = {},
                        .material = {}})
                .substeps(),
            34);
  EXPECT_EQ(make_truth(usual, {.substeps = 272}).substeps(), 272);
}

}  // namespace
}  // namespace lodestone::drop_series_test
