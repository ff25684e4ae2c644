#include "tools/compare/pile_comparison.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "reference/error.h"
#include "tests/temporary_folder.h"
#include "tests/tools/methods/box_job.h"
#include "tools/compare/pile_report.h"

namespace lodestone::pile_comparison_test {
namespace {

using testing::box_job;

PileObservation pile(std::vector<double> kinetic_energy, double sleep_time_s, double height_m) {
  PileObservation observed;
  observed.kinetic_energy = std::move(kinetic_energy);
  observed.sleep_time_s = sleep_time_s;
  observed.mean_height_m = height_m;
  return observed;
}

TEST(PileFigures, AreOfMeansOverPiles) {
  const std::vector truth = {pile({1.0, 2.0}, 2.0, 0.4), pile({3.0, 2.0}, 4.0, 0.6)};
  std::vector piles = {pile({2.0, 3.0}, 3.3, 0.25), pile({2.0, 1.8}, 3.3, 0.25)};
  piles[1].hovering = piles[0].hovering = 1;
  piles[1].max_penetration_m = 0.02;
  piles[0].end_penetration_m = 0.01;
  piles[0].median_penetration_m = 0.01, piles[1].median_penetration_m = 0.03;
  const PileFigures figures = compare_with_truth(truth, piles, *box_job().shape);
  EXPECT_NEAR(figures.ke_l1, 0.4 / 4.0, 1e-12);
  EXPECT_NEAR(figures.sleep_time_error, 0.1, 1e-12);
  EXPECT_NEAR(figures.mean_height_error, -0.5, 1e-12);
  EXPECT_NEAR(figures.penetration_over_size, 0.05, 1e-12);
  EXPECT_NEAR(figures.end_penetration_over_size, 0.025, 1e-12);
  EXPECT_NEAR(figures.median_penetration_over_size, 0.05, 1e-12);
  EXPECT_EQ(figures.hovering, 2);
}

TEST(PileComparison, MethodsStandBesideTheTruthAndTheFloor) {
  PileComparisonSettings settings;
  settings.conditions = {.bodies = 3, .side = 1.6};
  settings.piles = 1;
  settings.methods = {"full_2", "low"};
  const PileComparison comparison = compare_piles(box_job(), settings);
  ASSERT_EQ(comparison.rows.size(), 2U);
  EXPECT_EQ(comparison.truth.ke_l1, 0.0);
  EXPECT_GT(comparison.floor.ke_l1, 0.0);
  const PileFigures& full = comparison.rows[0].figures.value();
  EXPECT_GT(full.ke_l1, 0.0);
  EXPECT_NEAR(full.mean_height_m, comparison.truth.mean_height_m, 0.15);
  EXPECT_EQ(full.hovering + full.escaped, 0);
  EXPECT_LT(comparison.rows[0].momentum_residual, 1e-9);
  EXPECT_GT(comparison.rows[0].ns_per_body_step.value(), 0.0);
  EXPECT_FALSE(comparison.rows[1].figures.has_value());
  EXPECT_NE(comparison.rows[1].reason.find("194"), std::string::npos);
}

// Two boxes in half the steps: a row beside the methods, as far from the truth as its second batch is.
TEST(PileComparison, TheTruthIsCheckedAgainstAFinerOne) {
  PileComparisonSettings settings;
  settings.conditions = {.bodies = 2, .side = 0.8};
  settings.piles = 1;
  settings.methods = {};
  settings.check_truth = {"half_step"};
  const PileComparison comparison = compare_piles(box_job(), settings);
  ASSERT_EQ(comparison.rows.size(), 1U);
  const PileRow& row = comparison.rows[0];
  EXPECT_EQ(row.method, "truth_half_step");
  EXPECT_EQ(row.substeps, 2 * comparison.truth_substeps);
  EXPECT_EQ(row.dt_s, kObservationStep);
  EXPECT_NEAR(row.figures.value().sleep_time_s, comparison.floor.sleep_time_s, 0.5);
  EXPECT_FALSE(row.ns_per_body_step.has_value());
  EXPECT_THROW(make_finer_truth(box_job(), "finest"), InputError);
}

TEST(FinerTruth, ChangesWhatItsNameSays) {
  const auto settings_of = [](const Method& method) { return std::get<OdeMethod>(method.way).settings; };
  const OdeSettings truth = settings_of(make_pile_truth(box_job()));
  EXPECT_EQ(make_finer_truth(box_job(), "half_step").substeps(), 2 * make_pile_truth(box_job()).substeps());
  EXPECT_EQ(settings_of(make_finer_truth(box_job(), "iterations")).quick_step_iterations,
            4 * truth.quick_step_iterations);
  EXPECT_LT(truth.direct_contacts_max, 100);
  EXPECT_GT(settings_of(make_finer_truth(box_job(), "direct")).direct_contacts_max, 1'000'000);
}

// What is under `support` in piles: equal and opposite impulses, without a signature too.
TEST(PileTrials, SupportKeepsMomentum) {
  const DropJob job = box_job();
  const Method support{"statistical", StatisticalMethod{StatisticalModel::support, nullptr}};
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    EXPECT_LT(
        measure_momentum_residual(job, support, {.conditions = {.bodies = 27, .side = 1.6}, .seed = seed}),
        1e-12)
        << seed;
}

TEST(PileComparison, UnknownMethodsAndNarrowBinsAreBadInput) {
  PileComparisonSettings settings;
  settings.methods = {"fulll"};
  EXPECT_THROW(compare_piles(box_job(), settings), InputError);
  settings.methods = {"full"};
  settings.conditions.side = 0.3;
  EXPECT_THROW(compare_piles(box_job(), settings), InputError);
}

PileComparison two_rows() {
  PileComparison comparison{.shape = "box", .pile_count = 1, .truth_substeps = 34, .truth_iterations = 60};
  comparison.truth_a = comparison.truth_b = {pile({1.0, 0.5}, 1.0, 0.1)};
  PileRow full{{.method = "full", .model = ""}};
  full.figures.emplace();
  full.piles = {pile({1.0, 0.5}, 1.0, 0.1)};
  comparison.rows = {full, PileRow{{.method = "low", .model = "", .reason = "has too few faces"}}};
  return comparison;
}

TEST(PileReport, JsonHasTheKeysThatScriptsReadAndNullsForWhatIsLeftOut) {
  const auto json = json_of(two_rows());
  for (const auto& row : json["rows"])
    for (const char* key :
         {"method", "model", "ke_l1", "sleep_time_s", "mean_height_m", "max_penetration_m",
          "momentum_residual", "floor_ke_l1", "sleep_time_error", "mean_height_error",
          "penetration_over_size", "end_penetration_over_size", "median_penetration_over_size", "hovering",
          "escaped", "energy_rise", "ns_per_body_step"})
      EXPECT_TRUE(row.contains(key)) << key;
  EXPECT_EQ(json["rows"][0]["ke_l1"], 0.0);
  EXPECT_TRUE(json["rows"][1]["ke_l1"].is_null());
  EXPECT_TRUE(json["rows"][1]["hovering"].is_null());
}

TEST(PileReport, CsvHasALineForEachPileAndForEachSample) {
  const testing::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  save_piles(two_rows(), folder);
  const auto lines = [&](const char* name) {
    std::ifstream in(folder / name);
    int count = 0;
    for (std::string line; std::getline(in, line);) ++count;
    return count;
  };
  EXPECT_EQ(lines("piles.csv"), 1 + 3);
  EXPECT_EQ(lines("pile_energy.csv"), 1 + 3 * 2);
}

}  // namespace
}  // namespace lodestone::pile_comparison_test
