#include "lod/manager/step_log.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

using Lines = std::vector<std::pair<LogLevel, std::string>>;

Lines lines_of(const Counters& before, const StepReport& after) {
  Lines lines;
  StepLog log;
  log.set([&](LogLevel level, std::string_view text) { lines.emplace_back(level, std::string(text)); });
  log.begin_step(before);
  log.end_step(after);
  return lines;
}

TEST(StepLog, SaysWhatTheStepAddedAndNoMore) {
  Counters before;
  before.promotions_put_off = 5, before.contacts_dropped = 7, before.states_recovered = 1;
  StepReport report;
  report.step = 12, report.counters = before;
  EXPECT_TRUE(lines_of(before, report).empty());
  report.counters.contacts_dropped += 3;
  EXPECT_EQ(lines_of(before, report), (Lines{{LogLevel::warning, "step 12: 3 contacts dropped"}}));
  report.counters.promotions_put_off += 1;
  const Lines both = lines_of(before, report);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].first, LogLevel::info);
  EXPECT_EQ(both[0].second, "step 12: 1 promotions put off, for overlap with another body");
}

// Each count that a log tells of has a line of its own, under its step.
TEST(StepLog, EachKindOfTroubleHasALine) {
  Lines all;
  for (std::int64_t Counters::*count :
       {&Counters::promotions_put_off, &Counters::bodies_held_back, &Counters::states_recovered,
        &Counters::contacts_dropped, &Counters::ode_messages, &Counters::full_uneven_contacts}) {
    StepReport report;
    report.step = 3, report.counters.*count = 4;
    const Lines lines = lines_of({}, report);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_TRUE(lines[0].second.starts_with("step 3: 4 ")) << lines[0].second;
    for (const auto& [level, text] : all) EXPECT_NE(text, lines[0].second);
    all.push_back(lines[0]);
  }
}

TEST(StepLog, ThatNobodyLooksIsSaidOnceToEachFunction) {
  StepLog log;
  Lines lines;
  StepReport report;
  report.step = 5;
  const auto take = [&](LogLevel level, std::string_view text) { lines.emplace_back(level, text); };
  log.end_step(report, true);  // to nobody
  log.set(take);
  for (int i = 0; i < 2; ++i) log.end_step(report, true), log.end_step(report, false);
  EXPECT_EQ(
      lines,
      (Lines{{LogLevel::warning, "step 5: there is no viewpoint, so to the policy every body is far"}}));
  log.set(take);
  log.end_step(report, true);
  EXPECT_EQ(lines.size(), 2U);
}

TEST(StepLog, WithoutAFunctionNothingIsSaid) {
  StepLog log;
  StepReport report;
  report.counters.contacts_dropped = 1;
  log.begin_step({});
  EXPECT_NO_THROW(log.end_step(report));
}

}  // namespace
}  // namespace lodestone
