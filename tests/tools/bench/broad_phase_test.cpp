// `bench broad_phase`: the figures of few balls, and that wrong pairs would be seen.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"
#include "tools/bench/broad_phase_report.h"

namespace lodestone {
namespace {

TEST(BroadPhaseBench, EveryLayoutHasThePairsThatOthersFind) {
  BroadPhaseSettings settings;
  settings.bodies = {400};
  settings.steps = 3;
  const auto rows = bench_broad_phase(settings);
  ASSERT_EQ(rows.size(), ball_layouts().size());
  for (const BroadPhaseRow& row : rows) {
    EXPECT_EQ(row.fault, "") << row.layout;
    EXPECT_TRUE(row.checked_by.starts_with("hash") && row.checked_by.ends_with("all"))
        << row.layout << ": " << row.checked_by;
    EXPECT_NE(row.checked_by.find(" sweep "), std::string::npos)
        << row.layout << ": " << row.checked_by;  // ODE's hash space itself misses some of mixed sizes
    EXPECT_GT(row.fill_ns, 0.0);
    EXPECT_GT(row.cells, 1) << row.layout;
    EXPECT_EQ(row.grids > 1, row.layout == "mixed") << row.layout;
    EXPECT_GT(row.bytes_per_body, 8.0);
    ASSERT_TRUE(row.times_less);
  }
  EXPECT_GT(rows[1].pairs_per_body, 1.0);  // the pile
}

TEST(BroadPhaseBench, AlternativesThatWouldTakeTooLongAreLeftOut) {
  BroadPhaseSettings settings;
  settings.bodies = {300};
  settings.layouts = {"pile"};
  settings.row_seconds = 0.0;
  const BroadPhaseRow row = bench_broad_phase(settings).front();
  EXPECT_FALSE(row.ode_hash_ns || row.ode_sweep_ns || row.bullet_tree_ns || row.times_less);
  EXPECT_EQ(row.checked_by, "all");
}

TEST(BroadPhaseBench, BallsComeBackToWhereTheyWere) {
  for (const BallLayout& layout : ball_layouts()) {
    const Balls first = layout.make(50, 1);
    ASSERT_EQ(first.size(), 50u) << layout.name;
    EXPECT_NEAR(move(first, 3.0, 3, 1).x[7], move(first, 3.0, 5, 1).x[7], 1e-9);
    EXPECT_NE(move(first, 3.0, 3, 1).x[7], first.x[7]);
    EXPECT_EQ(move(first, 3.0, 8, 1).x[7], first.x[7]);
  }
}

TEST(BroadPhaseReport, NamesRowsWhosePairsDiffer) {
  const std::vector<BroadPhaseRow> rows = {{.layout = "pile", .bodies = 7, .fault = "hash found 3 pairs"}};
  EXPECT_NE(text_of(rows).find("wrong: pile of 7 bodies: hash found 3 pairs"), std::string::npos);
  EXPECT_EQ(json_of(rows)["rows"][0]["fault"], "hash found 3 pairs");
  EXPECT_TRUE(json_of(rows)["rows"][0]["checked_by"].is_null());
}

using BroadPhaseCommand = testing::CliTest;

TEST_F(BroadPhaseCommand, PrintsJsonAndWritesCsv) {
  const auto ended = run("bench broad_phase --bodies 60,90 --layouts layer,mixed --steps 2 --json --csv " +
                         name("figures.csv"));
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  ASSERT_EQ(json["rows"].size(), 4U);
  EXPECT_EQ(json["rows"][3]["bodies"], 90);
  const std::string csv = testing::bytes_of(at("figures.csv"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 5);
  EXPECT_TRUE(csv.starts_with("layout,bodies,threads,fill_ns_per_body,"));
  EXPECT_EQ(run("bench broad_phase --layouts nonsense").exit_code, 2);
}

}  // namespace
}  // namespace lodestone
