#include "signature/collision_heights.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi;
const CollisionHeights kHeights{.mean = {0.5f, 0.75f, 1.0f},
                                .deviation = {0.25f, 0.125f, 0.0f}};  // at α = 0, π/4, π/2

TEST(CollisionHeights, SamplesAreEvenInAlpha) {
  for (int i = 0; i < 3; ++i) {
    const HeightStatistics found = find_collision_height(kHeights, i * kPi / 4);
    EXPECT_NEAR(found.mean, kHeights.mean[std::size_t(i)], 1e-12) << i;
    EXPECT_NEAR(found.deviation, kHeights.deviation[std::size_t(i)], 1e-12) << i;
  }
}

TEST(CollisionHeights, BetweenThemTheyAreLinear) {
  const HeightStatistics found = find_collision_height(kHeights, kPi / 16);
  EXPECT_NEAR(found.mean, 0.5625, 1e-12);
  EXPECT_NEAR(found.deviation, 0.21875, 1e-12);
  EXPECT_NEAR(find_collision_height(kHeights, 7 * kPi / 16).mean, 0.9375, 1e-12);
}

TEST(CollisionHeights, WithoutInterpolationTheNearestCounts) {
  EXPECT_EQ(find_collision_height(kHeights, 0.9 * kPi / 8, false).mean, 0.5);
  EXPECT_EQ(find_collision_height(kHeights, 1.1 * kPi / 8, false).mean, 0.75);
  EXPECT_EQ(find_collision_height(kHeights, 1.1 * kPi / 8, false).deviation, 0.125);
}

TEST(CollisionHeights, BeyondTheEndsTheyStayTheSame) {
  EXPECT_EQ(find_collision_height(kHeights, -0.1).mean, 0.5);
  EXPECT_EQ(find_collision_height(kHeights, 2.0).mean, 1.0);
}

TEST(CollisionHeights, OneSampleCountsEverywhere) {
  const CollisionHeights one{.mean = {0.75f}, .deviation = {0.5f}};
  for (const bool interpolate : {false, true})
    for (const double alpha : {0.0, 1.0, kPi / 2}) {
      EXPECT_EQ(find_collision_height(one, alpha, interpolate).mean, 0.75);
      EXPECT_EQ(find_collision_height(one, alpha, interpolate).deviation, 0.5);
    }
}

}  // namespace
}  // namespace lodestone
