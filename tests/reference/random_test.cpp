#include "reference/random.h"

#include <gtest/gtest.h>

#include <set>

namespace lodestone {
namespace {

constexpr int kDraws = 40'000;

// The known answer of Philox4x32-10 for counter and key 0 (Random123's kat_vectors).
TEST(Random, IsPhilox) {
  RandomStream random(0, 0, 0);
  for (const std::uint32_t word : {0x9b00dbd8u, 0xbc57ac4cu, 0xe169c58du, 0x6627e8d5u})
    EXPECT_EQ(random.uniform(), (word + 0.5) * 0x1p-32);
}

TEST(Random, EveryPartOfTheKeyCounts) {
  std::set<double> first;
  for (const auto& [seed, a, b] : {std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>{1, 2, 3},
                                   {2, 2, 3},
                                   {1, 3, 3},
                                   {1, 2, 4},
                                   {1ull << 32 | 1, 2, 3},
                                   {1, 1ull << 32 | 2, 3}})
    first.insert(RandomStream(seed, a, b).uniform());
  EXPECT_EQ(first.size(), 6U);
  EXPECT_EQ(RandomStream(1, 2, 3).uniform(), RandomStream(1, 2, 3).uniform());
}

TEST(Random, UniformDrawsAreEvenAndLeaveTheEndsOut) {
  RandomStream random(1, 0, 0);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform(-2.0, 4.0);
    ASSERT_GT(x, -2.0);
    ASSERT_LT(x, 4.0);
    sum += x, squares += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 4.0 * std::sqrt(3.0 / kDraws));  // variance 6²/12
  EXPECT_NEAR(squares / kDraws, 4.0, 0.1);                        // 3 + 1²
}

TEST(Random, NormalDrawsHaveTheMomentsOfANormalDistribution) {
  RandomStream random(2, 0, 0);
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    sum += x, squares += x * x, fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 4.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 4.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourth / kDraws, 3.0, 4.0 * std::sqrt(96.0 / kDraws));
}

TEST(Random, DirectionsAreEvenOverTheSphere) {
  RandomStream random(3, 0, 0);
  Vec3 sum = Vec3::Zero();
  Mat3 squares = Mat3::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Vec3 u = random.direction();
    ASSERT_NEAR(u.norm(), 1.0, 1e-14);
    sum += u / kDraws, squares += u * u.transpose() / kDraws;
  }
  const double spread = 4.0 / std::sqrt(3.0 * kDraws);
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), spread);
  EXPECT_LT((squares - Mat3::Identity() / 3.0).cwiseAbs().maxCoeff(), spread);
}

// Rotations drawn evenly turn by an angle of density (1 − cos θ)/π: its mean is π/2 + 2/π.
TEST(Random, OrientationsAreEvenOverRotations) {
  RandomStream random(4, 0, 0);
  double angle = 0.0;
  Vec3 turned = Vec3::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Quat q = random.orientation();
    ASSERT_NEAR(q.norm(), 1.0, 1e-14);
    angle += 2.0 * std::acos(std::min(1.0, std::abs(q.w()))) / kDraws;
    turned += q * Vec3(1, 2, 3).normalized() / kDraws;
  }
  EXPECT_NEAR(angle, std::numbers::pi / 2 + 2.0 / std::numbers::pi, 4.0 * 0.65 / std::sqrt(kDraws));
  EXPECT_LT(turned.cwiseAbs().maxCoeff(), 4.0 / std::sqrt(3.0 * kDraws));
}

}  // namespace
}  // namespace lodestone
