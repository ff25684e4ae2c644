// `bench rungs`: every change is measured, and one that is seen is said to be.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"
#include "tools/bench/rungs_bench.h"

namespace lodestone {
namespace {

const RungsRow& row_of(const RungsHeap& heap, const std::string& change) {
  return *std::ranges::find(heap.rows, change, &RungsRow::change);
}

TEST(RungsBench, UnseenIsWhatItSays) {
  EXPECT_TRUE(is_unseen({.p999_mm = 5.0, .max_mm = 20.0}));
  EXPECT_FALSE(is_unseen({.p999_mm = 5.1, .max_mm = 20.0}));
  EXPECT_FALSE(is_unseen({.p999_mm = 5.0, .max_mm = 20.1}));
}

TEST(RungsBench, TakesEveryBodyThroughEveryRung) {
  const auto heaps = bench_rungs({.shapes = {"l"}, .bodies = 25, .rounds = 2, .frames = 5, .slice = 10});
  ASSERT_EQ(heaps.size(), 2u);
  for (const RungsHeap& heap : heaps) {
    EXPECT_EQ(heap.bodies, 25);
    for (const char* change :
         {"none", "support to tables", "tables to support", "support to full", "full to support"})
      EXPECT_EQ(row_of(heap, change).changes, 50) << change;
    EXPECT_EQ(row_of(heap, "tables to full").changes, 20);  // one slice a round
    EXPECT_EQ(row_of(heap, "none").put_off, 0);
    EXPECT_LT(row_of(heap, "none").unexplained_max_mm, 1.0);  // who still falls over goes by his velocities
    for (const RungsRow& row : heap.rows) {
      EXPECT_LE(row.p50_mm, row.p99_mm);
      EXPECT_LE(row.p999_mm, row.max_mm);
      EXPECT_LE(row.unexplained_max_mm, row.max_mm + 1e-9);
    }
  }
  EXPECT_FALSE(heaps[0].kept_awake);
  EXPECT_EQ(heaps[0].asleep_before, 25);
  EXPECT_TRUE(heaps[1].kept_awake);
  EXPECT_EQ(heaps[1].asleep_before, 0);
}

using RungsCommand = testing::CliTest;

TEST_F(RungsCommand, PrintsJsonAndWritesCsv) {
  const auto ended =
      testing::run_shell(testing::quoted(LODESTONE_CLI) +
                         " bench rungs --shape l --bodies 6 --rounds 1 --frames 2 --json --csv " +
                         name("figures.csv") + " 2>&1");
  EXPECT_TRUE(ended.exit_code == 0 || ended.exit_code == 1) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["rounds"], 1);
  ASSERT_EQ(json["rows"].size(), 14u);
  EXPECT_EQ(json["rows"][0]["heap"], "asleep");
  EXPECT_EQ(json["rows"][13]["heap"], "awake");
  const bool all_unseen = std::ranges::all_of(json["rows"], [](const auto& row) {
    return row["change"] == "none" || row["unseen"].template get<bool>();
  });
  EXPECT_EQ(ended.exit_code, all_unseen ? 0 : 1);
  EXPECT_TRUE(testing::bytes_of(at("figures.csv")).starts_with("shape,bodies,heap,asleep_before,"));
  EXPECT_EQ(run("bench rungs --shape cube").exit_code, 2);
}

}  // namespace
}  // namespace lodestone
