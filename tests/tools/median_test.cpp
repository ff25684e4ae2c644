#include "tools/median.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(Median, IsTheMiddleOne) {
  EXPECT_EQ(median_of({3}), 3);
  EXPECT_EQ(median_of({9, 1, 5}), 5);
  EXPECT_EQ(median_of({4, 1, 3, 2}), 3);  // of an even number the upper one
  EXPECT_EQ(median_of({2, 2, 2, 1}), 2);
  EXPECT_EQ(mean_of({1, 2, 6}), 3);
}

TEST(Percentiles, AreTheLeastThatSoManyDoNotExceed) {
  const std::vector<double> ten = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  EXPECT_EQ(percentile_of(ten, 0.1), 1);
  EXPECT_EQ(percentile_of(ten, 0.11), 2);
  EXPECT_EQ(percentile_of(ten, 0.5), 5);
  EXPECT_EQ(percentile_of(ten, 0.99), 10);
  EXPECT_EQ(percentile_of(ten, 1.0), 10);
  EXPECT_EQ(percentile_of({7}, 0.001), 7);
  EXPECT_EQ(percentile_of({}, 0.5), 0);
}

}  // namespace
}  // namespace lodestone
