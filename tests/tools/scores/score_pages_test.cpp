#include "tools/scores/score_pages.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/message_of.h"
#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

using testing::message_of;
using ScoresCommand = testing::CliTest;

std::string text_of_file(const std::string& name) {
  std::ifstream file(std::filesystem::path(LODESTONE_SOURCE_DIR) / name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<ScoreRow> frustum() {
  const auto row = [](const char* method, double score) {
    return ScoreRow{{"shapes", "frustum", "usual", 300, method, 0.016667}, score, 0.0895, 1.0, "abc"};
  };
  return {row("support", 0.1084), row("tables", 1.234)};
}

TEST(ScorePages, ATableIsMadeOfTheRowsBetweenItsTwoLines) {
  const std::string page = "# Page\n<!-- scores: shapes -->\nold\n<!-- end of scores -->\nmore\n";
  const auto [made, tables] = with_score_tables("p.md", page, frustum());
  EXPECT_EQ(tables, 1);
  EXPECT_NE(made.find("| frustum | .089 | .108 | 1.23 |  |  |\n"), std::string::npos) << made;
  EXPECT_NE(made.find("\nAt abc, steps of 1/60 s"), std::string::npos);
  EXPECT_EQ(made.find("old"), std::string::npos);
  EXPECT_TRUE(made.ends_with("<!-- end of scores -->\nmore\n"));
  EXPECT_EQ(with_score_tables("p.md", made, frustum()).text, made);
}

TEST(ScorePages, WhatAPageAsksForAndIsNotThereIsNamedByItsLine) {
  EXPECT_EQ(message_of([] {
              with_score_tables("p.md", "a\n\n<!-- scores: pies -->\n<!-- end of scores -->\n", {});
            }),
            "p.md: line 3: found the table \"pies\", expected one of drops, shapes, conditions, ground, "
            "materials");
  EXPECT_EQ(message_of([] { with_score_tables("p.md", "<!-- scores: drops -->\n", {}); }),
            "p.md: line 1: found a table without an end, expected <!-- end of scores --> under it");
  EXPECT_EQ(
      message_of([] { with_score_tables("p.md", "# Page\n", {}); }),
      "p.md: found no line <!-- scores: NAME -->, expected one; NAME: one of drops, shapes, conditions, "
      "ground, materials");
}

// Where it fails: build/lodestone compare scores --page tools/README.md
TEST(ScorePages, ThePageHasTheScoresThatAreKept) {
  const std::string page = text_of_file("tools/README.md");
  const auto rows = parse_scores("scores.csv", text_of_file("tests/baselines/scores.csv"));
  EXPECT_TRUE(with_score_tables("tools/README.md", page, rows).text == page);
}

TEST_F(ScoresCommand, SaysWhatItHasWrittenAndWhatAPageLacks) {
  std::ofstream(at("p.md")) << "# Page\n<!-- scores: shapes -->\n<!-- end of scores -->\n";
  std::ofstream(at("none.md")) << "# Page\n";
  const testing::Ended written = run("compare scores --page " + name("p.md"));
  EXPECT_EQ(written.exit_code, 0);
  EXPECT_TRUE(written.out.ends_with("p.md (1 tables)\n")) << written.out;
  const testing::Ended none = run("compare scores --page " + name("none.md"));
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_NE(none.out.find("none.md: found no line <!-- scores: "), std::string::npos) << none.out;
}

}  // namespace
}  // namespace lodestone
