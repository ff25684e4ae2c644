#include "scenes/time_summary.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace lodestone {
namespace {

TEST(TimeSummary, Percentiles) {
  std::vector<double> sample(101);
  std::iota(sample.rbegin(), sample.rend(), 0.0);
  const TimeSummary summary = summarize(sample);
  EXPECT_EQ(summary.p50, 50);
  EXPECT_EQ(summary.p95, 95);
  EXPECT_EQ(summary.p99, 99);
  EXPECT_EQ(summary.mean, 50);
  EXPECT_EQ(summary.max, 100);
  EXPECT_EQ(summarize({}).max, 0);
  EXPECT_EQ(summarize(std::vector{7.0}).p95, 7);
}

}  // namespace
}  // namespace lodestone
