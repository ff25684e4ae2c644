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
  result.last_report.full = 4;
  result.last_report.statistical = 6;
  result.last_report.support = 5;
  result.last_report.tables = 1;
  result.last_report.asleep = 2;
  result.last_report.counters.energy_clamps = 7;
  result.stage_ms.full_ms = 4.5;
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

TEST(RunReport, WhereOdeGaveUpIsSaidBesideWhatThereIs) {
  RunResult result = three_steps();
  EXPECT_FALSE(json_of(result).contains("failure"));
  result.failure = SimulationError("ODE gave up"), result.incomplete = true;
  EXPECT_EQ(json_of(result)["failure"], "ODE gave up");
  EXPECT_EQ(json_of(result)["steps"], 3);
  EXPECT_EQ(json_of(result)["incomplete"], true);
  EXPECT_EQ(exit_code_of(result), ExitCode::diverged);
}

TEST(RunReport, RungsAddUp) {
  const auto levels = json_of(three_steps())["levels"];
  EXPECT_EQ(levels["support"].get<int>() + levels["tables"].get<int>(), levels["statistical"].get<int>());
  EXPECT_NE(text_of(three_steps()).find("rungs        4 full, 5 support, 1 tables\n"), std::string::npos)
      << text_of(three_steps());
}

TEST(RunReport, TheAuditIsThereOnceItHasABody) {
  RunResult result = three_steps();
  EXPECT_FALSE(json_of(result).contains("audit"));
  AuditReport& audit = result.last_report.audit;
  audit.watched = 2;
  EXPECT_EQ(json_of(result)["audit"]["watched"], 2);
  EXPECT_EQ(text_of(result).find("audit"), std::string::npos) << "nothing was compared yet";
  audit.bodies = 5, audit.left_out = 1;
  audit.rest_time_s = {.full = 0.9, .demoted = 1.0, .deviation = 0.2, .difference = {0.05, 0.15}};
  audit.drift = 0.3, audit.drift_interval = {0.2, 0.4};
  const auto json = json_of(result)["audit"];
  EXPECT_EQ(json["bodies"], 5);
  EXPECT_EQ(json["left_out"], 1);
  EXPECT_EQ(json["rest_time_s"]["full"], 0.9);
  EXPECT_EQ(json["rest_time_s"]["demoted"], 1.0);
  EXPECT_EQ(json["drift_interval"][1], 0.4);
  EXPECT_NE(text_of(result).find("audit        5 demoted bodies beside themselves in full"),
            std::string::npos)
      << text_of(result);
}

TEST(RunReport, ABudgetHasItsFiguresAndAnotherPolicyNone) {
  RunResult result = three_steps();
  EXPECT_FALSE(json_of(result).contains("budget"));
  EXPECT_EQ(text_of(result).find("budget"), std::string::npos);
  result.budget = {.budget_ms = 4.0,
                   .budget_work = std::nullopt,
                   .steps = 591,
                   .over = 2,
                   .step_ms = {.p50 = 1.5, .p99 = 3.5, .max = 4.5},
                   .mean_bodies = {900.0, 90.0, 10.0}};
  result.budget->mean_cost[std::size_t(Rung::full)] = {
      .predicted_ms = 1.25, .measured_ms = 1.5, .work = 1200};
  const auto json = json_of(result)["budget"];
  EXPECT_EQ(json["ms"], 4.0);
  EXPECT_EQ(json["steps"], 591);
  EXPECT_EQ(json["over"], 2);
  EXPECT_EQ(json["p50"], 1.5);
  EXPECT_EQ(json["p99"], 3.5);
  EXPECT_EQ(json["max"], 4.5);
  EXPECT_EQ(json["mean_full"], 10.0);
  EXPECT_EQ(json["mean_support"], 90.0);
  EXPECT_EQ(json["mean_tables"], 900.0);
  EXPECT_EQ(json["rungs"]["full"]["measured_ms"], 1.5);
  EXPECT_NE(text_of(result).find("budget       4 ms: 2 of 591 steps over;"), std::string::npos)
      << text_of(result);
}

TEST(RunReport, ABudgetOfWorkIsNotTimed) {
  RunResult result = three_steps();
  result.budget = {.budget_ms = std::nullopt,
                   .budget_work = 2000.0,
                   .steps = 591,
                   .over = std::nullopt,
                   .mean_work = 1900.0};
  const auto json = json_of(result)["budget"];
  EXPECT_EQ(json["work"], 2000.0);
  EXPECT_FALSE(json.contains("ms"));
  EXPECT_TRUE(json["over"].is_null());
  EXPECT_NE(text_of(result).find("budget       2000 units: 1900 foretold, mean of 591 steps;"),
            std::string::npos)
      << text_of(result);
}

TEST(RunReport, PictureOfTheViewpoint) {
  RunResult result = three_steps();
  EXPECT_FALSE(json_of(result).contains("in_picture"));
  result.in_picture = {.min_full = 8, .mean_full = 12.5};
  EXPECT_EQ(json_of(result)["in_picture"]["min_full"], 8);
  EXPECT_EQ(json_of(result)["in_picture"]["mean_full"], 12.5);
  EXPECT_NE(text_of(result).find("in picture   8 full at least, 12.5 on average"), std::string::npos);
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

TEST(RunReport, AForkThatDivergesIsSaidToo) {
  RunResult result = three_steps();
  ForkedRun fork;
  fork.result = three_steps();
  fork.mean_distance_m = {0.5};
  result.fork = std::make_shared<const ForkedRun>(fork);
  EXPECT_EQ(exit_code_of(result), ExitCode::done);
  fork.result.finite = false;
  result.fork = std::make_shared<const ForkedRun>(fork);
  EXPECT_EQ(exit_code_of(result), ExitCode::diverged);
  EXPECT_NE(text_of(result).find("\nDIVERGED: a state of the fork was not finite\n"), std::string::npos);
}

TEST(RunReport, TextLeavesOutCountersAtZero) {
  const std::string text = text_of(three_steps());
  EXPECT_NE(text.find("energy_clamps 7"), std::string::npos);
  EXPECT_EQ(text.find("ode_messages"), std::string::npos);
}

}  // namespace
}  // namespace lodestone
