#include "tools/compare/drop_comparison.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "reference/error.h"
#include "tests/temporary_folder.h"
#include "tests/tools/methods/box_job.h"
#include "tools/compare/drop_report.h"

namespace lodestone::drop_comparison_test {
namespace {

using testing::box_job;

DropComparisonSettings few_drops(std::vector<std::string> methods, double dt_s) {
  DropComparisonSettings settings;
  settings.trials = 12;
  settings.methods = std::move(methods);
  settings.dt_s = {dt_s};
  return settings;
}

// A method that takes the truth's steps is the truth: nothing in how methods are observed and scored adds to
// the floor.
TEST(DropComparison, TheTruthAsAMethodScoresTheFloor) {
  const DropComparison comparison = compare_drops(box_job(), few_drops({"full_1"}, kObservationStep / 34));
  ASSERT_EQ(comparison.rows.size(), 1U);
  EXPECT_DOUBLE_EQ(comparison.rows[0].score->value.score, comparison.floor.value.score);
  EXPECT_GT(comparison.floor.value.score, 0.0);
}

TEST(DropComparison, SubstepsAreShorterSteps) {
  const DropComparison whole = compare_drops(box_job(), few_drops({"full_8"}, kObservationStep));
  const DropComparison half = compare_drops(box_job(), few_drops({"full_4"}, kObservationStep / 2));
  EXPECT_DOUBLE_EQ(whole.rows[0].score->value.score, half.rows[0].score->value.score);
}

TEST(DropComparison, ThreadsDoNotMatter) {
  DropComparisonSettings settings = few_drops({"full_1"}, kObservationStep);
  settings.trials = 20;
  settings.threads = 1;
  const DropComparison one = compare_drops(box_job(), settings);
  settings.threads = 4;
  const DropComparison four = compare_drops(box_job(), settings);
  EXPECT_EQ(one.floor.value.score, four.floor.value.score);
  EXPECT_EQ(one.rows[0].score->value.score, four.rows[0].score->value.score);
  EXPECT_EQ(one.rows[0].score->interval, four.rows[0].score->interval);
}

TEST(DropComparison, ASphereHasNoRestPoses) {
  DropJob job;
  job.shape = std::make_shared<const Shape>(make_sphere_shape(0.1));
  const DropComparison comparison = compare_drops(job, few_drops({"full"}, kObservationStep));
  EXPECT_FALSE(comparison.floor.value.tv.has_value());
  EXPECT_FALSE(comparison.rows[0].score->value.w_rest_time.has_value());
  EXPECT_EQ(comparison.floor.value.parts, 4);
}

TEST(DropComparison, WhatCannotBeHadIsLeftOutWithTheReason) {
  const DropComparison comparison = compare_drops(box_job(), few_drops({"low"}, kObservationStep));
  EXPECT_FALSE(comparison.rows[0].score.has_value());
  const auto row = json_of(comparison)["rows"][0];
  EXPECT_TRUE(row["score"].is_null());
  EXPECT_NE(row["reason"].get<std::string>().find("194"), std::string::npos);
}

TEST(DropComparison, UnknownMethodIsBadInput) {
  EXPECT_THROW(make_methods({"fulll"}, box_job(), {}, 1, {}), InputError);
}

TEST(DropReport, JsonHasTheKeysThatScriptsReadAndNullsForWhatIsUndefined) {
  DropComparison comparison{.shape = "box", .trials = 2, .truth_substeps = 34};
  comparison.rows.push_back(DropRow{{.method = "full", .model = ""}});
  comparison.rows[0].score = ScoreWithInterval{};
  comparison.rows[0].ns_per_body_step = 12.0;
  const auto json = json_of(comparison);
  for (const char* key : {"shape", "trials", "rows"}) EXPECT_TRUE(json.contains(key)) << key;
  const auto row = json["rows"][0];
  for (const char* key :
       {"method", "model", "dt_s", "substeps", "score", "score_ci", "floor", "floor_ci", "parts", "w_bounces",
        "w_rest_time", "w_distance", "w_peak", "ke_w", "tv", "ns_per_body_step"})
    EXPECT_TRUE(row.contains(key)) << key;
  EXPECT_TRUE(row["model"].is_null());
  EXPECT_TRUE(row["tv"].is_null());
  EXPECT_EQ(row["score_ci"].size(), 2U);
}

TEST(DropReport, CsvHasALineForEachDrop) {
  DropComparison comparison{.shape = "box", .trials = 2, .truth_substeps = 34};
  comparison.truth_a.resize(2);
  comparison.truth_b.resize(2);
  comparison.rows.push_back(DropRow{{.method = "full", .model = ""}});
  comparison.rows[0].drops.resize(2);
  const testing::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  save_drops(comparison, folder);
  std::ifstream in(folder / "drops.csv");
  int lines = 0;
  for (std::string line; std::getline(in, line);) {
    EXPECT_EQ(std::ranges::count(line, ','), 11) << line;
    ++lines;
  }
  EXPECT_EQ(lines, 7);
}

TEST(DropReport, AFolderThatCannotBeIsBadInput) {
  EXPECT_THROW(save_drops(DropComparison{}, "/dev/null/folder"), InputError);
}

// ODE's error reduction throws back what strikes without restitution, in steps of any length: a truth that
// pushes overlap apart slowly has no such bounce, and `support` is nearer to it.
TEST(DropComparison, WithoutRestitutionTheTruthBouncesByItsErrorReduction) {
  DropJob job = box_job();
  job.material.restitution = 0.0;
  DropComparisonSettings settings;
  settings.trials = 20;
  settings.methods = {"waiting"};
  settings.costs = false;
  const auto first_rebound = [](const DropComparison& comparison) {
    double sum = 0.0;
    for (const DropObservation& drop : comparison.truth_a) sum += drop.first_rebound_m / 20.0;
    return sum;
  };
  const DropComparison by_its_law = compare_drops(job, settings);
  settings.truth.push_m_per_s = 0.05;
  const DropComparison slowly = compare_drops(job, settings);
  EXPECT_GT(first_rebound(by_its_law), 3.0 * first_rebound(slowly));
  EXPECT_LT(slowly.rows[0].score->value.score, by_its_law.rows[0].score->value.score);
  EXPECT_EQ(json_of(slowly)["truth"]["push_m_per_s"], 0.05);
  EXPECT_TRUE(json_of(by_its_law)["truth"]["push_m_per_s"].is_null());
}

}  // namespace
}  // namespace lodestone::drop_comparison_test
