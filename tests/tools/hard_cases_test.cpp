// The hard cases themselves, shortened here, whole in the long suite; and what is made of their figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case_report.h"

namespace lodestone {
namespace {

TEST(HardCaseFigures, OneThatIsNoneIsNotHidden) {
  const double nan = std::nan("");
  EXPECT_EQ(worse(1.0, 2.0), 2.0);
  EXPECT_EQ(worse(2.0, 1.0), 2.0);
  EXPECT_EQ(lesser(2.0, 1.0), 1.0);
  for (const double later : {0.0, 3.0}) {
    EXPECT_TRUE(std::isnan(worse(worse(1.0, nan), later)));
    EXPECT_TRUE(std::isnan(lesser(lesser(1.0, nan), later)));
  }
}

void expect_kept(const HardCase& one, const HardCaseSettings& settings) {
  const auto rows = one.measure(settings);
  EXPECT_FALSE(rows.empty());
  for (const HardCaseRow& row : rows)
    EXPECT_TRUE(passes(row) || !row.odes_own.empty())
        << one.id << ' ' << row.what << ": " << row.value << ' ' << row.unit << ", bound " << row.bound;
}

std::string id_of(const ::testing::TestParamInfo<HardCase>& info) { return std::string(info.param.id); }

// Both without a prefix: the name of a suite that takes minutes begins with Long.
class HardCases : public ::testing::TestWithParam<HardCase> {};
TEST_P(HardCases, KeepTheirBoundsWhenShort) { expect_kept(GetParam(), {.quick = true}); }
INSTANTIATE_TEST_SUITE_P(, HardCases, ::testing::ValuesIn(hard_cases().begin(), hard_cases().end()), id_of);

class LongHardCases : public ::testing::TestWithParam<HardCase> {};
TEST_P(LongHardCases, KeepTheirBounds) { expect_kept(GetParam(), {}); }
INSTANTIATE_TEST_SUITE_P(, LongHardCases, ::testing::ValuesIn(hard_cases().begin(), hard_cases().end()),
                         id_of);

// The bounds bite: the same set-up with ODE's own friction axes stands still, which is a failure with a
// reason.
TEST(HardCaseList, ACaseCanFail) {
  const auto rolling = std::ranges::find(hard_cases(), "F4", &HardCase::id);
  ASSERT_NE(rolling, hard_cases().end());
  const auto rows = rolling->measure({.quick = true});
  const auto failed = std::ranges::find_if_not(rows, passes);
  ASSERT_NE(failed, rows.end());
  EXPECT_NEAR(failed->value, 3.145, 0.01);  // m²/s², as published for ODE
  EXPECT_FALSE(failed->odes_own.empty());
}

// Of whatever group: F1 to F19, then S1 to S17.
TEST(HardCaseList, NamesEachCaseOnceInTheOrderOfItsNumbers) {
  std::vector<std::string> expected, ids;
  for (int i = 1; i <= 19; ++i) expected.push_back("F" + std::to_string(i));
  for (int i = 1; i <= 17; ++i) expected.push_back("S" + std::to_string(i));
  for (const HardCase& one : hard_cases()) ids.emplace_back(one.id);
  EXPECT_EQ(ids, expected);
}

TEST(HardCaseRow, FailsBeyondItsBoundAndWithoutAValue) {
  EXPECT_TRUE(passes({.what = "", .value = 1.0, .bound = 1.0}));
  EXPECT_FALSE(passes({.what = "", .value = 1.1, .bound = 1.0}));
  EXPECT_FALSE(passes({.what = "", .value = std::nan(""), .bound = 1.0}));
  EXPECT_TRUE(passes({.what = "", .value = 1.1, .bound = 1.0, .side = BoundSide::at_least}));
  EXPECT_FALSE(passes({.what = "", .value = 0.9, .bound = 1.0, .side = BoundSide::at_least}));
  EXPECT_FALSE(passes({.what = "", .value = std::nan(""), .bound = 1.0, .side = BoundSide::at_least}));
}

HardCaseResult result_of(double value, const std::string& odes_own) {
  return {"F0", {{.what = "a figure", .value = value, .bound = 1.0, .unit = "m", .odes_own = odes_own}}};
}

TEST(HardCaseReport, FailsTheCheckUnlessTheFailureIsOdesOwn) {
  const HardCaseResult kept = result_of(0.5, ""), kept_after_all = result_of(0.5, "ODE sinks"),
                       odes = result_of(2.0, "ODE sinks"), ours = result_of(2.0, "");
  EXPECT_EQ(exit_code_of(std::vector{kept, kept_after_all}), ExitCode::done);
  EXPECT_EQ(exit_code_of(std::vector{kept, odes}), ExitCode::done);
  EXPECT_EQ(exit_code_of(std::vector{odes, ours}), ExitCode::check_failed);
}

TEST(HardCaseReport, GivesAReasonOnlyForAFailure) {
  const auto json = json_of(
      std::vector{result_of(0.5, "ODE sinks"), result_of(2.0, "ODE sinks"), result_of(std::nan(""), "")});
  const auto& cases = json["cases"];
  ASSERT_EQ(cases.size(), 3U);
  for (const auto& one : cases)
    for (const char* key : {"id", "what", "value", "bound", "op", "unit", "pass", "reason"})
      EXPECT_TRUE(one.contains(key)) << key;
  EXPECT_TRUE(cases[0]["pass"].get<bool>() && cases[0]["reason"].is_null());
  EXPECT_FALSE(cases[1]["pass"].get<bool>());
  EXPECT_EQ(cases[1]["reason"], "ODE sinks");
  EXPECT_TRUE(!cases[2]["pass"].get<bool>() && cases[2]["value"].is_null() && cases[2]["reason"].is_null());
  EXPECT_EQ(cases[0]["op"], "<=");
}

TEST(HardCaseReport, SaysInWordsWhatFailed) {
  const std::string text =
      text_of(std::vector{result_of(0.5, ""), result_of(2.0, "ODE sinks"), result_of(3.0, "")});
  EXPECT_NE(text.find("1 of 3 figures keep their bound"), std::string::npos) << text;
  EXPECT_NE(text.find("F0 a figure: ODE sinks"), std::string::npos) << text;
  EXPECT_NE(text.find("F0 a figure: FAILED"), std::string::npos) << text;
}

}  // namespace
}  // namespace lodestone
