#include "reference/hull/spiral_directions.h"

#include <gtest/gtest.h>

#include <vector>

namespace lodestone {
namespace {

TEST(SpiralDirections, AreEvenOverTheSphere) {
  constexpr int kDirections = 1'000;
  Vec3 mean = Vec3::Zero();
  Mat3 squares = Mat3::Zero();
  std::vector<Vec3> all;
  for (int i = 0; i < kDirections; ++i) {
    const Vec3 u = all.emplace_back(spiral_direction(i, kDirections));
    EXPECT_NEAR(u.norm(), 1.0, 1e-15);
    mean += u / kDirections, squares += u * u.transpose() / kDirections;
  }
  // 30 to 1,000 times as even as random ones, whose means are off by 1/√(3·1000) = .018.
  EXPECT_LT(mean.norm(), 1e-3);
  EXPECT_LT((squares - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(), 1e-3);
  // Each has its part of the sphere for itself: of an area 4π/n a square's side is √(4π/n) = .11.
  double closest = 2.0;
  for (int i = 0; i < kDirections; ++i)
    for (int j = 0; j < i; ++j) closest = std::min(closest, (all[i] - all[j]).norm());
  EXPECT_GT(closest, 0.09);
}

TEST(SpiralDirections, RunFromPoleToPole) {
  EXPECT_DOUBLE_EQ(spiral_direction(0, 10).z(), 0.9);
  EXPECT_DOUBLE_EQ(spiral_direction(9, 10).z(), -0.9);
  EXPECT_EQ(spiral_direction(0, 1).z(), 0.0);
}

}  // namespace
}  // namespace lodestone
