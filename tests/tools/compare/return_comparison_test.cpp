// `compare return` and `compare errors`: what is compared, and what the commands print.
#include "tools/compare/return_comparison.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"
#include "tests/tools/methods/box_job.h"

namespace lodestone {
namespace {

const ReturnMeasure& measure_of(const ReturnComparison& comparison, const std::string& name) {
  return *std::ranges::find(comparison.measures, name, &ReturnMeasure::name);
}

class ReturnComparisonTest : public testing::CliTest {};

TEST_F(ReturnComparisonTest, ABodyThatIsAwayAtTablesIsToldFromOneAtSupport) {
  const DropJob job = testing::box_job();
  ReturnSettings settings;
  settings.runs = 60;
  const ReturnComparison support = compare_return(job, settings);
  settings.away = StatisticalModel::tables;
  settings.published = true;
  const ReturnComparison tables = compare_return(job, settings);
  for (const ReturnComparison& found : {support, tables}) {
    EXPECT_EQ(found.runs, 60);
    EXPECT_EQ(found.measures.size(), 4u);
    EXPECT_NEAR(found.all_full_again, 1.0, 1e-9);
    EXPECT_GE(found.mean_rung_changes, 2.0);
  }
  const ReturnMeasure rest = measure_of(support, "time to rest s");
  EXPECT_NEAR(rest.critical, 0.248, 0.001);  // 1.358 √(2 / 60)
  EXPECT_LT(rest.distance, rest.critical);
  EXPECT_GT(measure_of(tables, "time to rest s").distance, rest.critical);
  EXPECT_EQ(measure_of(tables, "time to rest s").floor, rest.floor)
      << "the same runs that are full all the time";
}

TEST_F(ReturnComparisonTest, PrintsJson) {
  const auto ended =
      run("compare return box:0.2,0.3,0.4 --runs 4 --leave 0.1 --away 0.2 --rung tables --json");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["runs"], 4);
  EXPECT_EQ(json["rung"], "tables");
  EXPECT_EQ(json["leave_s"], 0.1);
  ASSERT_EQ(json["measures"].size(), 4u);
  EXPECT_EQ(json["measures"][1]["name"], "time to rest s");
  EXPECT_GT(json["measures"][1]["mean_full"], 0.0);
  EXPECT_FALSE(json["measures"][3].contains("critical_5_percent")) << "of the rest pose there is none";
  EXPECT_EQ(run("compare return box:0.2,0.3,0.4 --rung full").exit_code, 2);
}

TEST_F(ReturnComparisonTest, ErrorsOfTheRungsArePrintedAndKept) {
  const auto ended = run("compare errors box:0.2,0.3,0.4 --trials 8 --keep --json");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["drops"], 8);
  EXPECT_GT(json["floor"]["score"], 0.0);
  for (const char* rung : {"full", "support", "tables"}) {
    EXPECT_GT(json["rungs"][rung]["score"], 0.0) << rung;
    EXPECT_GT(json["rungs"][rung]["drift"], 0.0) << rung;
  }
  ASSERT_TRUE(json["file"].is_string());
  EXPECT_TRUE(std::filesystem::exists(json["file"].get<std::string>()));
  EXPECT_TRUE(json["file"].get<std::string>().starts_with(at("cache").string()));
  const auto unkept = run("compare errors box:0.2,0.3,0.4 --trials 2 --json");
  EXPECT_TRUE(nlohmann::json::parse(unkept.out)["file"].is_null());
}

}  // namespace
}  // namespace lodestone
