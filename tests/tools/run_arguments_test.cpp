#include "tools/run_arguments.h"

#include <gtest/gtest.h>

#include "tests/tools/parsed_command.h"
#include "tools/progress.h"

namespace lodestone {
namespace {

RunArguments run_asked(const std::string& line) {
  return testing::parse<RunArguments>(line, add_run_arguments);
}
std::string run_refused(const std::string& line) {
  return testing::refusal<RunArguments>(line, add_run_arguments);
}

TEST(RunArguments, EachReachesItsSetting) {
  const RunArguments a = run_asked(
      "--steps 7 --dt 1/50 --seed 9 --threads 3 --level full --model tables --no-cache "
      "--mesh-path /m --untrusted --audit-ms 2");
  ProgressLine line;
  const RunSettings settings = run_settings(a, line);
  EXPECT_EQ(settings.steps, 7);
  EXPECT_EQ(settings.threads, 3);
  EXPECT_EQ(settings.level, LevelChoice::full);
  EXPECT_EQ(settings.model, StatisticalModel::tables);
  ASSERT_TRUE(settings.dt_s);
  EXPECT_DOUBLE_EQ(*settings.dt_s, 0.02);
  EXPECT_EQ(a.loading.seed, 9U);
  EXPECT_TRUE(a.no_cache);
  EXPECT_TRUE(a.loading.untrusted);
}

TEST(RunArguments, WithoutAnyTheSceneDecides) {
  ProgressLine line;
  const RunSettings settings = run_settings(run_asked(""), line);
  EXPECT_FALSE(settings.dt_s);
  EXPECT_FALSE(settings.steps);
  EXPECT_FALSE(settings.budget_ms);
  EXPECT_FALSE(settings.budget_work);
  EXPECT_FALSE(settings.model);
  EXPECT_GE(settings.threads, 1);
}

TEST(RunArguments, ABudgetIsOfTimeOrOfWorkOrOfDistance) {
  EXPECT_EQ(run_asked("--budget-ms 2.5").running.budget_ms, 2.5);
  EXPECT_EQ(run_asked("--budget-work 2000").running.budget_work, 2000.0);
  EXPECT_EQ(run_asked("--full-within-m 0").running.full_within_m, 0.0);
  for (const char* line : {"--budget-ms 1 --budget-work 1", "--budget-ms 1 --full-within-m 1",
                           "--budget-work 1 --full-within-m 1", "--budget-ms 0", "--budget-ms -1",
                           "--budget-ms nan", "--budget-work inf", "--budget-ms 1x"})
    EXPECT_NE(run_refused(line), "no error") << line;
}

TEST(RunArguments, WhatIsOutOfRangeIsRefused) {
  for (const char* line : {"--steps 0", "--steps 1e3", "--dt 0", "--dt 1/0", "--dt fast", "--threads -1",
                           "--threads 5000", "--level best", "--model full", "--audit-ms -1", "--seed -1"})
    EXPECT_NE(run_refused(line), "no error") << line;
}

TEST(RunArguments, EveryLevelHasItsName) {
  for (const auto& [name, level] : {std::pair{"auto", LevelChoice::automatic},
                                    {"full", LevelChoice::full},
                                    {"support", LevelChoice::support},
                                    {"tables", LevelChoice::tables},
                                    {"statistical", LevelChoice::statistical}})
    EXPECT_EQ(run_asked(std::string("--level ") + name).running.level, level) << name;
}

// As they were given, so that whoever reads what a page says it was made by can make it again.
TEST(RunArguments, AreSaidAgain) {
  EXPECT_EQ(options_of(RunArguments{}), "");
  RunArguments given;
  given.step = "1/120", given.loading.seed = 7;
  given.running.steps = 20, given.running.threads = 2, given.running.level = LevelChoice::statistical;
  given.running.model = StatisticalModel::tables, given.running.full_within_m = 2.5;
  EXPECT_EQ(
      options_of(given),
      " --steps 20 --dt 1/120 --seed 7 --threads 2 --level statistical --model tables --full-within-m 2.5");
}

}  // namespace
}  // namespace lodestone
