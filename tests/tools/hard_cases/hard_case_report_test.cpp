#include "tools/hard_cases/hard_case_report.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/temporary_folder.h"
#include "tools/report/report_table.h"

namespace lodestone {
namespace {

const HardCaseRow kKept{.what = "kept", .value = 1.0, .bound = 2.0, .unit = "m"};
const HardCaseRow kFailed{.what = "failed", .value = 3.0, .bound = 2.0};
const HardCaseRow kOdes{.what = "ode's", .value = 3.0, .bound = 2.0, .odes_own = "it drifts"};
const HardCaseRow kNone{.what = "none", .value = std::numeric_limits<double>::quiet_NaN(), .bound = 2.0};

std::vector<HardCaseResult> all_kinds() { return {{"F1", {kKept, kFailed}}, {"F2", {kOdes, kNone}}}; }

TEST(HardCaseReports, OnBothSidesABoundHolds) {
  HardCaseRow row{.what = "", .value = 2.0, .bound = 2.0};
  EXPECT_TRUE(passes(row));
  row.side = BoundSide::at_least;
  EXPECT_TRUE(passes(row));
  row.value = 1.0;
  EXPECT_FALSE(passes(row));
  row.side = BoundSide::at_most;
  EXPECT_TRUE(passes(row));
  EXPECT_FALSE(passes(kNone));
}

TEST(HardCaseReports, TextCountsWhatIsKeptAndSaysWhy) {
  const std::string text = text_of(all_kinds());
  EXPECT_NE(text.find("1 of 4 figures keep their bound"), std::string::npos) << text;
  EXPECT_NE(text.find("F1 failed: FAILED"), std::string::npos);
  EXPECT_NE(text.find("F2 ode's: it drifts"), std::string::npos);
  EXPECT_EQ(text.find("F1 kept:"), std::string::npos);
}

TEST(HardCaseReports, JsonHasNoNumberThatIsNone) {
  const auto cases = json_of(all_kinds())["cases"];
  ASSERT_EQ(cases.size(), 4U);
  EXPECT_TRUE(cases[3]["value"].is_null());
  EXPECT_EQ(cases[0]["pass"], true);
  EXPECT_TRUE(cases[0]["reason"].is_null());
  EXPECT_EQ(cases[2]["reason"], "it drifts");
  EXPECT_TRUE(cases[1]["reason"].is_null());
  EXPECT_EQ(cases[0]["op"], "<=");
  EXPECT_EQ(cases[1]["id"], "F1");
}

TEST(HardCaseReports, CsvIsTheJson) {
  const testing::TemporaryFolder folder;
  save_csv(all_kinds(), folder.at("cases.csv"));
  EXPECT_EQ(parse_report_table("t", testing::bytes_of(folder.at("cases.csv"))).rows,
            json_of(all_kinds())["cases"]);
}

TEST(HardCaseReports, TheCheckFailsForOursAlone) {
  const HardCaseResult kept{"F1", {kKept}}, odes{"F2", {kOdes}}, failed{"F3", {kKept, kFailed}};
  EXPECT_EQ(exit_code_of(std::vector{kept, odes}), ExitCode::done);
  EXPECT_EQ(exit_code_of(std::vector{kept, failed}), ExitCode::check_failed);
  EXPECT_EQ(exit_code_of({}), ExitCode::done);
}

}  // namespace
}  // namespace lodestone
