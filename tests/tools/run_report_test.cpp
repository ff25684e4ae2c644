#include "tools/run_report.h"

#include <gtest/gtest.h>

#include <limits>

namespace lodestone {
namespace {

RunResult three_steps() {
  RunResult result;
  result.steps = 3;
  result.bodies = 10;
  result.state_hash = 0xabc;
  result.reports.resize(3);
  result.reports.back().full = 4;
  result.reports.back().statistical = 6;
  result.reports.back().asleep = 2;
  result.reports.back().counters.energy_clamps = 7;
  for (StepReport& report : result.reports) report.times.full_ms = 1.5;
  return result;
}

TEST(RunReport, JsonSpeaksOfTheLastStep) {
  const auto json = json_of(three_steps());
  EXPECT_EQ(json["state_hash"], "0000000000000abc");
  EXPECT_EQ(json["levels"]["full"], 4);
  EXPECT_EQ(json["levels"]["asleep"], 2);
  EXPECT_EQ(json["counters"]["energy_clamps"], 7);
  EXPECT_DOUBLE_EQ(json["stage_mean_ms"]["full"].get<double>(), 1.5);
}

TEST(RunReport, JsonHasNoNumberThatIsNone) {
  RunResult result = three_steps();
  result.energy_max_j = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(json_of(result)["energy_max_j"].is_null());
}

TEST(RunReport, ExitCodes) {
  RunResult result = three_steps();
  EXPECT_EQ(exit_code_of(result), ExitCode::done);
  result.checks.push_back({.name = "max_penetration_m", .value = 0.1, .bound = 0.02, .pass = false});
  EXPECT_EQ(exit_code_of(result), ExitCode::check_failed);
  EXPECT_NE(text_of(result).find("FAILED: max_penetration_m"), std::string::npos);
  result.finite = false;
  EXPECT_EQ(exit_code_of(result), ExitCode::diverged);
}

TEST(RunReport, TextLeavesOutCountersAtZero) {
  const std::string text = text_of(three_steps());
  EXPECT_NE(text.find("energy_clamps 7"), std::string::npos);
  EXPECT_EQ(text.find("ode_messages"), std::string::npos);
}

}  // namespace
}  // namespace lodestone
