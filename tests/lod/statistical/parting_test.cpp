#include "lod/statistical/parting.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodestone {
namespace {

// As lengths grow by λ under the same gravity, speeds grow by √λ.
TEST(Parting, SpeedScalesWithTheRootOfLengthAndGravity) {
  for (const double radius : {0.01, 0.13, 2.0})
    for (const double gravity : {1.62, 9.81, 25.0}) {
      EXPECT_NEAR(parting_speed(4.0 * radius, gravity), 2.0 * parting_speed(radius, gravity), 1e-12);
      EXPECT_NEAR(parting_speed(radius, 4.0 * gravity), 2.0 * parting_speed(radius, gravity), 1e-12);
    }
}

TEST(Parting, WithoutGravityTheyPartAllTheSame) {
  EXPECT_GT(parting_speed(0.1, 0.0), 0.0);
  EXPECT_EQ(parting_speed(0.1, 0.0), parting_speed(0.1, 1.0));
}

TEST(Parting, IsTooSlowToBeSeen) { EXPECT_NEAR(parting_speed(0.13, 9.81) / 60, 0.002, 2e-4); }

}  // namespace
}  // namespace lodestone
