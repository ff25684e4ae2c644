#include "lod/broad_phase/ball_pairs.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone {
namespace {

struct Row {
  std::vector<float> x, y, z, reach;
  std::vector<std::uint32_t> index;
};

Row draw_row(std::uint32_t seed, int count) {
  RandomStream random(seed, 0, 0);
  Row row;
  for (int i = 0; i < count; ++i) {
    for (auto* array : {&row.x, &row.y, &row.z}) array->push_back(float(random.uniform(-1, 1)));
    row.reach.push_back(float(random.uniform(0, 0.6)));
    row.index.push_back(1000 + 7 * std::uint32_t(i));
  }
  return row;
}

// In order, and the same whatever the width and wherever the run begins and ends.
TEST(NearBalls, AreThoseOfALookAtEach) {
  const Row row = draw_row(3, 100);
  const BallArrays balls{row.x.data(), row.y.data(), row.z.data(), row.reach.data(), row.index.data()};
  const NearBall ball{0.1f, -0.2f, 0.0f, 0.5f, 5};
  for (std::uint32_t begin = 0; begin < 20; ++begin)
    for (const std::uint32_t end : {begin, begin + 1, begin + 15, begin + 16, begin + 33, 100u}) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = begin; i < end; ++i)
        if (Eigen::Vector3f(row.x[i] - ball.x, row.y[i] - ball.y, row.z[i] - ball.z).norm() <
            row.reach[i] + ball.reach)
          expected.push_back(row.index[i]);
      const auto check = [&]<Simd Width>() {
        if (Width > find_simd()) return;
        std::vector<std::uint32_t> first(end - begin + BallPairs::kOverrun), second(first);
        const std::uint32_t count =
            find_near_balls<Width>(balls, ball, begin, end, first.data(), second.data());
        second.resize(count);
        EXPECT_EQ(second, expected) << begin << " … " << end << ", width " << int(Width);
        for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(first[i], 5U);
      };
      check.operator()<Simd::portable>();
#if defined(__x86_64__)
      check.operator()<Simd::avx2>();
      check.operator()<Simd::avx512>();
#endif
    }
}

TEST(NearBalls, TouchingIsNotMeeting) {
  const float zero = 0.0f, reach = 0.5f, x = 1.0f;
  const std::uint32_t index = 9;
  std::uint32_t first[20], second[20];
  const BallArrays balls{&x, &zero, &zero, &reach, &index};
  EXPECT_EQ(find_near_balls<Simd::portable>(balls, {0, 0, 0, 0.5f, 1}, 0, 1, first, second), 0U);
  EXPECT_EQ(find_near_balls<Simd::portable>(balls, {0, 0, 0, 0.50001f, 1}, 0, 1, first, second), 1U);
}

TEST(BallPairs, AreKeptInOrderAndFiltered) {
  BallPairs pairs;
  for (std::uint32_t i = 0; i < 100; ++i) pairs.add(i, 2 * i);
  ASSERT_EQ(pairs.size(), 100);
  pairs.filter([](std::uint32_t first, std::uint32_t) { return first % 3 == 0; });
  ASSERT_EQ(pairs.size(), 34);
  for (std::int64_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(pairs.first(i), std::uint32_t(3 * i));
    EXPECT_EQ(pairs.second(i), std::uint32_t(6 * i));
  }
  pairs.clear();
  EXPECT_EQ(pairs.size(), 0);
}

}  // namespace
}  // namespace lodestone
