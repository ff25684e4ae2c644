#include "scenes/time_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/allocations.h"

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

TEST(TimeTally, IsExactForAsManyAsAreKept) {
  TimeTally tally;
  std::vector<double> sample;
  for (int i = 0; i < 1000; ++i) sample.push_back(0.01 * ((i * 7919) % 1000)), tally.add(sample.back());
  const TimeSummary exact = summarize(sample), tallied = tally.summary();
  EXPECT_EQ(tallied.p50, exact.p50);
  EXPECT_EQ(tallied.p99, exact.p99);
  EXPECT_EQ(tallied.mean, exact.mean);
  EXPECT_EQ(TimeTally().summary().max, 0);
}

// Times over seven decades, and some that are none.
TEST(TimeTally, BeyondThatItIsRightToThreeInAThousand) {
  TimeTally tally;
  std::vector<double> sample;
  for (std::size_t i = 0; i < 3 * kExactTimes; ++i) {
    sample.push_back(std::pow(10.0, -4.0 + 7.0 * double((i * 7919) % 10'007) / 10'007));
    tally.add(sample.back());
  }
  const TimeSummary exact = summarize(sample), tallied = tally.summary();
  EXPECT_NEAR(tallied.p50 / exact.p50, 1.0, 0.003);
  EXPECT_NEAR(tallied.p95 / exact.p95, 1.0, 0.003);
  EXPECT_NEAR(tallied.p99 / exact.p99, 1.0, 0.003);
  EXPECT_NEAR(tallied.mean / exact.mean, 1.0, 1e-9);
  EXPECT_EQ(tallied.max, exact.max);
  for (const double odd : {0.0, -1.0, 1e300}) tally.add(odd);
  EXPECT_EQ(tally.summary().max, 1e300);
}

TEST(TimeTally, HoldsNoMoreHoweverManyThereAre) {
  const std::int64_t before = bytes_held();
  TimeTally tally;
  std::int64_t most = 0;
  for (std::size_t i = 0; i < 40 * kExactTimes; ++i) {
    tally.add(double(i % 100));
    most = std::max(most, bytes_held() - before);
  }
  EXPECT_GE(tally.summary().max, 99.0);
  EXPECT_LE(most, 150'000);
}

}  // namespace
}  // namespace lodestone
