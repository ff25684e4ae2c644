// Table 1 of few bodies: the layout, what the rows say, and what is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "reference/error.h"
#include "tests/temporary_folder.h"
#include "tests/tools/cli_fixture.h"
#include "tools/bench/table1_report.h"
#include "tools/results.h"

namespace lodestone {
namespace {

TEST(Table1Job, NoTwoBodiesTouchAtTheStart) {
  const double radius = make_table1_job().shape->radius;
  for (const int bodies : {10, 100, 700}) {
    std::vector<Vec3> centers;
    for (int i = 0; i < bodies; ++i) centers.push_back(table1_start(i, bodies, 1).position);
    for (int i = 0; i < bodies; ++i) {
      EXPECT_GT(centers[i].z(), 2.0 * radius);
      for (int j = 0; j < i; ++j)
        ASSERT_GT((centers[i] - centers[j]).norm(), 2.0 * radius) << i << ' ' << j << " of " << bodies;
    }
  }
}

TEST(Table1Job, ThePapersImprovementOverItsFullSimulation) {
  EXPECT_NEAR(paper_times("full_plain", 1'000).step_ms / paper_times("statistical", 1'000).step_ms, 134, 1);
  EXPECT_EQ(paper_times("full_plain", 10'000).step_ms, 0.0);
  EXPECT_EQ(paper_times("sphere", 10).step_ms, 0.0);
}

Table1Settings few(std::vector<std::string> methods) {
  Table1Settings settings;
  settings.bodies = {12};
  settings.methods = std::move(methods);
  return settings;
}

TEST(Table1, RowsComeWithTheirStagesAndTheSameStatesEveryTime) {
  const auto settings = few({"sphere", "spheres7"});
  const auto rows = measure_table1(settings), again = measure_table1(settings);
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_TRUE(rows[i].step_ms && rows[i].collision_ms && rows[i].response_ms);
    EXPECT_GE(*rows[i].step_ms, *rows[i].collision_ms);
    EXPECT_EQ(rows[i].awake, (std::array{12, 12, 12}));
    EXPECT_GT(rows[i].bytes_per_body, 100.0);
    EXPECT_EQ(rows[i].state_hash, again[i].state_hash);
  }
  EXPECT_NE(rows[0].state_hash, rows[1].state_hash);
  EXPECT_DOUBLE_EQ(*rows[0].times_less_than_spheres7, *rows[1].step_ms / *rows[0].step_ms);
  EXPECT_DOUBLE_EQ(*rows[1].times_less_than_sphere, *rows[0].step_ms / *rows[1].step_ms);
  EXPECT_FALSE(rows[0].times_less_than_full_plain);
}

TEST(Table1, RowsThatWouldTakeTooLongAreLeftOut) {
  auto settings = few({"sphere"});
  settings.row_seconds = 1e-9;
  const auto rows = measure_table1(settings);
  EXPECT_FALSE(rows[0].step_ms);
  EXPECT_NE(rows[0].left_out.find("would take"), std::string::npos) << rows[0].left_out;
  settings = few({"full_plain"});
  settings.bodies = {1'001};
  EXPECT_NE(measure_table1(settings)[0].left_out.find("1000 bodies"), std::string::npos);
}

// Not in bytes, nor a thousand times too much: no bound of speed, which is the machine's.
TEST(Bandwidth, OfACacheIsInGigabytesASecond) {
  const double found = measure_bandwidth(1 << 18, 1);
  EXPECT_GT(found, 1.0);  // a level 2 cache has ten times as much
  EXPECT_LT(found, 1e4);
  EXPECT_GT(level3_bytes(), level2_bytes());
}

TEST(Table1, WhatARowMovesIsSetBesideTheMachine) {
  std::vector<Table1Row> rows = {{.bodies = 1'000,
                                  .method = "statistical",
                                  .model = "tables",
                                  .step_ms = 0.1,
                                  .bytes_moved_per_body = 1'000.0},
                                 {.bodies = 1'000,
                                  .method = "statistical",
                                  .model = "tables",
                                  .threads = 2,
                                  .step_ms = 0.1,
                                  .bytes_moved_per_body = 1'000.0},
                                 {.bodies = 1'000, .method = "sphere", .step_ms = 0.1}};
  compare_with({.threads = 2, .memory_one = 20.0, .memory = 40.0, .cache_one = 100.0, .cache = 200.0}, rows);
  EXPECT_DOUBLE_EQ(*rows[0].moved_gb_per_s, 10.0);
  EXPECT_DOUBLE_EQ(*rows[0].share_of_memory, 0.5);
  EXPECT_DOUBLE_EQ(*rows[1].share_of_memory, 0.25);
  EXPECT_DOUBLE_EQ(*rows[1].share_of_cache, 0.05);
  EXPECT_FALSE(rows[2].moved_gb_per_s);
  const std::string text = roofline_text_of(
      {.threads = 2, .memory_one = 20.0, .memory = 40.0, .cache_one = 100.0, .cache = 200.0}, rows);
  EXPECT_EQ(std::ranges::count(text, '\n'), 6) << text;  // the machine, a gap, a heading, a rule, two rows
}

TEST(Table1Report, CsvHasACellForEachKeyOfTheJson) {
  const std::vector<Table1Row> rows = {{.bodies = 10, .method = "full_plain", .left_out = "too slow"},
                                       {.bodies = 10,
                                        .method = "statistical",
                                        .model = "tables",
                                        .step_ms = 0.5,
                                        .awake = {3, 2, 1},
                                        .state_hash = 255}};
  const testing::TemporaryFolder folder;
  const auto file = folder.at("table1.csv");
  save_csv(json_of(rows)["rows"], json_of(Table1Row{}), file);
  std::istringstream lines(testing::bytes_of(file));
  const auto json = json_of(rows);
  for (std::string line; std::getline(lines, line);)
    EXPECT_EQ(std::size_t(std::ranges::count(line, ',')) + 1, json["rows"][0].size()) << line;
  EXPECT_TRUE(json["rows"][0]["step_ms"].is_null());
  EXPECT_EQ(json["rows"][0]["reason"], "too slow");
  EXPECT_EQ(json["rows"][1]["state_hash"], "00000000000000ff");
  EXPECT_EQ(json["rows"][1]["awake"][2], 1);
  EXPECT_THROW(save_csv(json_of(rows)["rows"], json_of(Table1Row{}), "/dev/null/table.csv"), InputError);
}

}  // namespace
}  // namespace lodestone
