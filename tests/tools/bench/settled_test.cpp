// `bench settled`: a disturbance wakes what it touches, and no more.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/cli_fixture.h"
#include "tools/bench/settled_bench.h"

namespace lodestone {
namespace {

TEST(SettledBench, ABodyThatFallsInWakesAFew) {
  SettledSettings settings;
  settings.bodies = 4'000;
  settings.steps = 60;
  const auto rows = bench_settled(settings);
  ASSERT_EQ(rows.size(), 2u);  // tables, support
  for (const SettledRow& row : rows) {
    EXPECT_EQ(row.awake, 0) << int(row.model);
    EXPECT_LT(row.settling_steps, 300);
    EXPECT_GT(row.woken, 1);  // the one that fell, and another
    EXPECT_LE(row.woken, 8);  // 5 at tables, 2 at support (a million sleepers: 4 and 5)
    EXPECT_GT(row.farthest_woken_m, 0.0);
    EXPECT_LT(row.farthest_woken_m, 8.0);  // 3.1 and 4.1 (support with a million 5.7)
    EXPECT_EQ(row.woken_unseen, 0);
    EXPECT_GT(row.settled_us, 0.0);
    EXPECT_GT(row.bytes_per_body, 100.0);
  }
}

using SettledCommand = testing::CliTest;

TEST_F(SettledCommand, PrintsJsonAndWritesCsv) {
  const auto ended = run("bench settled --bodies 50 --steps 5 --json --csv " + name("figures.csv"));
  EXPECT_EQ(ended.exit_code, 0) << ended.out;
  const auto json = nlohmann::json::parse(ended.out);
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][1]["model"], "support");
  EXPECT_EQ(json["rows"][0]["bodies"], 50);
  EXPECT_TRUE(testing::bytes_of(at("figures.csv")).starts_with("model,bodies,threads,settling_steps,"));
  EXPECT_EQ(run("bench settled --bodies 0").exit_code, 2);
}

}  // namespace
}  // namespace lodestone
