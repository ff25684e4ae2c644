#include "lod/statistical/rest_law.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(RestLaw, SpeedsScaleWithTheRootOfTheSize) {
  const RestLaw law;
  EXPECT_DOUBLE_EQ(law.sleep_speed(0.2), 0.05);
  EXPECT_DOUBLE_EQ(law.sleep_speed(0.8), 0.1);
  EXPECT_DOUBLE_EQ(law.sleep_speed(0.002), 0.005);
  EXPECT_DOUBLE_EQ(law.wake_speed(0.2), 0.1);
}

TEST(RestLaw, AmongOthersStillIsBySpeedAloneByEnergyUnderGravity) {
  const RestLaw law;
  EXPECT_DOUBLE_EQ(law.still_energy(true, 0.2, 9.81), 0.5 * 0.05 * 0.05);
  EXPECT_DOUBLE_EQ(law.still_energy(true, 0.2, 1.62), 0.5 * 0.05 * 0.05 * 1.62 / 9.81);
  EXPECT_DOUBLE_EQ(law.still_energy(false, 0.2, 9.81), 2.5e-4 * 9.81 * 0.2);
  EXPECT_DOUBLE_EQ(law.still_energy(false, 0.2, 1.62) / law.still_energy(false, 0.2, 9.81), 1.62 / 9.81);
  EXPECT_FLOAT_EQ(law.still_time(true, 0.2, 9.81), 0.1f);
  EXPECT_FLOAT_EQ(law.still_time(false, 0.2, 9.81), 0.5f);
}

// As it rocks: √(R/g) as long, but no shorter than on earth at .3 m. Without gravity nothing rocks.
TEST(RestLaw, WhatIsLargeOrOnTheMoonMustBeStillForLonger) {
  const RestLaw law;
  EXPECT_FLOAT_EQ(law.still_time(true, 2.7, 9.81), 0.3f);
  EXPECT_FLOAT_EQ(law.still_time(true, 0.3, 9.81 / 4.0), 0.2f);
  EXPECT_FLOAT_EQ(law.still_time(true, 0.002, 9.81), 0.1f);
  EXPECT_FLOAT_EQ(law.still_time(false, 50.0, 1e-3), 5.0f);
  EXPECT_FLOAT_EQ(law.still_time(true, 1.8, 0.0), 0.1f);
  EXPECT_DOUBLE_EQ(law.still_energy(true, 0.2, 0.0), 0.5 * 0.05 * 0.05);
}

// Whatever a caller sets: energies by the square of the speed, times by the time.
TEST(RestLaw, OtherThresholdsScaleAllAlike) {
  SleepThresholds thresholds;
  const RestLaw usual(thresholds);
  thresholds.speed *= 3.0, thresholds.time *= 2.0;
  const RestLaw law(thresholds);
  EXPECT_DOUBLE_EQ(law.sleep_speed(0.1), 3.0 * usual.sleep_speed(0.1));
  EXPECT_DOUBLE_EQ(law.wake_speed(0.1), 3.0 * usual.wake_speed(0.1));
  for (const bool among_others : {true, false}) {
    EXPECT_DOUBLE_EQ(law.still_energy(among_others, 0.1, 9.81),
                     9.0 * usual.still_energy(among_others, 0.1, 9.81));
    EXPECT_FLOAT_EQ(law.still_time(among_others, 0.1, 9.81),
                    2.0f * usual.still_time(among_others, 0.1, 9.81));
  }
}

}  // namespace
}  // namespace lodestone
