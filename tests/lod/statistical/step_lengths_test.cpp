#include "lod/statistical/step_lengths.h"

#include <gtest/gtest.h>

namespace lodestone::step_lengths_test {
namespace {

constexpr double kFrame = 1.0 / 60.0;  // s

TEST(StepLengths, EqualStepsTakeAllThatIsKnown) {
  StepLengths lengths;
  for (int i = 0; i < 3; ++i) {
    const StepLengths::Shares shares = lengths.begin(kFrame);
    EXPECT_TRUE(shares.remembers);
    EXPECT_EQ(shares.of_forces, 1.0);
    EXPECT_EQ(shares.of_impulses, 1.0);
  }
}

TEST(StepLengths, AShortStepLeavesWhatIsKnown) {
  StepLengths lengths;
  lengths.begin(kFrame);
  const StepLengths::Shares shares = lengths.begin(1e-6);
  EXPECT_FALSE(shares.remembers);
  EXPECT_EQ(shares.of_forces, 1.0);
  EXPECT_DOUBLE_EQ(shares.of_impulses, 1e-6 / kFrame);
  EXPECT_TRUE(lengths.begin(kFrame).remembers);
}

TEST(StepLengths, ShortStepsAreRememberedInTheEnd) {
  StepLengths lengths;
  lengths.begin(kFrame);
  int steps = 0;
  while (!lengths.begin(1e-3).remembers) ++steps;
  EXPECT_GT(steps, 3);
  EXPECT_LT(steps, 20);
}

TEST(StepLengths, AForceOfShortStepsIsNotExpectedToLast) {
  StepLengths lengths;
  lengths.begin(1e-6);
  EXPECT_DOUBLE_EQ(lengths.begin(kFrame).of_forces, 2e-6 / kFrame);
}

}  // namespace
}  // namespace lodestone::step_lengths_test
