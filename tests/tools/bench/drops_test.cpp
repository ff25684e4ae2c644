#include <gtest/gtest.h>

#include "tests/tools/methods/box_job.h"
#include "tools/bench/drops_bench.h"

namespace lodestone {
namespace {

using testing::box_job;

TEST(DropsBench, CountsWholeStepsOfBodiesThatAreAwake) {
  const std::vector<DropsRow> rows = bench_drops(box_job(), {.bodies = 9, .methods = {"waiting", "full_1"}});
  ASSERT_EQ(rows.size(), 2u);
  for (const DropsRow& row : rows) {
    ASSERT_TRUE(row.seconds) << row.method;
    EXPECT_GE(row.awake_body_steps, 9 * 20) << row.method;  // nobody sleeps before a third of a second
    EXPECT_LT(row.awake_body_steps, 9 * kDropsSteps) << row.method;  // all are at rest before ten
    EXPECT_NEAR(*row.ns_per_body_step * double(row.awake_body_steps), 1e9 * *row.seconds, 1.0) << row.method;
    EXPECT_NEAR(*row.awake * kDropsSteps, double(row.awake_body_steps), 1e-6) << row.method;
  }
}

TEST(DropsBench, AMethodThatCannotBeHadSaysWhy) {
  const std::vector<DropsRow> rows = bench_drops(box_job(), {.bodies = 1, .methods = {"low"}});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_FALSE(rows[0].seconds);
  EXPECT_NE(rows[0].left_out, "");
}

}  // namespace
}  // namespace lodestone
