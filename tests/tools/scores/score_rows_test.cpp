#include "tools/scores/score_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/message_of.h"

namespace lodestone {
namespace {

using testing::message_of;

const std::string kHead = "series,shape,condition,trials,method,step_s,score,floor,bound,commit\n";

ScoreRow row(const std::string& series, const std::string& condition, double score) {
  return {{series, "box:1,2,3", condition, 100, "support", 0.016667}, score, 0.05, 0.1, "abc"};
}

TEST(ScoreRows, AreReadAsTheyWereWritten) {
  const std::vector<ScoreRow> rows = {row("drops", "usual", 0.0512),
                                      row("materials", "restitution=0 friction=1", 1.25)};
  const auto read = parse_scores("a.csv", csv_of(rows));
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].drops, rows[i].drops);
    EXPECT_EQ(read[i].score, rows[i].score);
    EXPECT_EQ(read[i].floor, rows[i].floor);
    EXPECT_EQ(read[i].bound, rows[i].bound);
    EXPECT_EQ(read[i].commit, rows[i].commit);
  }
}

TEST(ScoreRows, WhatIsNoRowIsNamedByItsLine) {
  const auto message = [](const std::string& csv) { return message_of([&] { parse_scores("a.csv", csv); }); };
  EXPECT_EQ(message(kHead + "drops,box,usual\n"),
            "a.csv: line 2: found 3 cells, expected 10: "
            "series,shape,condition,trials,method,step_s,score,floor,bound,commit");
  EXPECT_EQ(message("# about\n" + kHead + "drops,box,usual,many,support,.1,.1,.1,.1,abc\n"),
            "a.csv: line 3: found \"many\", expected a number from 0");
  for (const std::string bound : {"nan", "inf"})
    EXPECT_EQ(message(kHead + "drops,box,usual,2,support,.1,.1,.1," + bound + ",abc\n"),
              "a.csv: line 2: found \"" + bound + "\", expected a number from 0");
  const std::string line = "drops,box,usual,9,support,.1,.1,.1,.1,abc\n";
  EXPECT_EQ(message(kHead + line + line),
            "a.csv: line 3: found the drops of a line above again, expected each once");
  EXPECT_EQ(message("shape,score\n"),
            "a.csv: line 1: found \"shape,score\", expected "
            "series,shape,condition,trials,method,step_s,score,floor,bound,commit");
  EXPECT_EQ(message("# nothing\n"),
            "a.csv: found no table, expected "
            "series,shape,condition,trials,method,step_s,score,floor,bound,commit");
}

TEST(ScoreRows, WhatIsMeasuredAnewTakesItsOldPlace) {
  const std::vector<ScoreRow> kept = {row("drops", "usual", 0.1), row("drops", "a", 0.2),
                                      row("shapes", "usual", 0.3)};
  const std::vector<ScoreRow> measured = {row("drops", "b", 0.5), row("drops", "usual", 0.4),
                                          row("materials", "c", 0.6)};
  const auto now = with_measured(kept, measured);
  std::string order;
  for (const ScoreRow& r : now) order += fmt::format("{}/{} ", r.drops.series, r.drops.condition);
  EXPECT_EQ(order, "drops/usual drops/a drops/b shapes/usual materials/c ");
  EXPECT_EQ(now[0].score, 0.4);
  EXPECT_EQ(now[1].score, 0.2);
}

TEST(ScoreRows, ABoundIsAsFarAboveTheFloorAsTheScoresIntervalReaches) {
  ScoreWithInterval score;
  score.value.score = 0.06;
  score.interval = {0.04, 0.09};
  EXPECT_NEAR(bound_of(score, 0.05), 0.09, 1e-12);
  EXPECT_NEAR(bound_of(score, 0.08), 0.11, 1e-12);
}

}  // namespace
}  // namespace lodestone
