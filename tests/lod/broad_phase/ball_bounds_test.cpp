#include "lod/broad_phase/ball_bounds.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/random.h"

namespace lodestone {
namespace {

struct BoundedBalls {
  std::vector<double> x, y, z;
  std::vector<float> reach;
  explicit BoundedBalls(int count) {
    RandomStream random(15, std::uint64_t(count), 0);
    for (int i = 0; i < count; ++i) {
      for (auto* axis : {&x, &y, &z}) axis->push_back(random.uniform(-100, 100));
      reach.push_back(float(random.uniform(0.1, 5.0)));
    }
  }
  BallSpan span() const { return {x, y, z, reach}; }
};

std::vector<Simd> widths() {
  std::vector<Simd> all = {Simd::portable};
  for (const Simd simd : {Simd::avx2, Simd::avx512})
    if (find_simd() >= simd) all.push_back(simd);
  return all;
}

void expect_same(const BallBounds& a, const BallBounds& b) {
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_EQ(a.most_reach, b.most_reach);
  EXPECT_EQ(a.least_reach, b.least_reach);
  EXPECT_EQ(a.count, b.count);
}

constexpr std::pair<int, int> kRanges[] = {{0, 0},  {0, 1},  {3, 3},   {0, 15},
                                           {0, 16}, {5, 38}, {0, 100}, {84, 100}};

TEST(BallBounds, AreThoseOfALookAtEachBall) {
  const BoundedBalls balls(100);
  for (const Simd simd : widths())
    for (const auto& [begin, end] : kRanges) {
      BallBounds expected;
      for (int i = begin; i < end; ++i) {
        const auto at = std::size_t(i);
        ++expected.count;
        const double place[] = {balls.x[at], balls.y[at], balls.z[at]};
        for (std::size_t a = 0; a < 3; ++a)
          expected.low[a] = std::min(expected.low[a], place[a]),
          expected.high[a] = std::max(expected.high[a], place[a]);
        expected.least_reach = std::min(expected.least_reach, balls.reach[at]);
        expected.most_reach = std::max(expected.most_reach, balls.reach[at]);
      }
      expect_same(find_ball_bounds(balls.span(), simd, begin, end), expected);
    }
}

// Joined they are those of all, wherever they were parted.
TEST(BallBounds, PartsAddUp) {
  const BoundedBalls balls(100);
  const BallBounds all = find_ball_bounds(balls.span(), Simd::portable, 0, 100);
  for (const int cut : {0, 1, 16, 50, 99, 100}) {
    BallBounds sum = find_ball_bounds(balls.span(), Simd::portable, cut, 100);
    sum.add(find_ball_bounds(balls.span(), Simd::portable, 0, cut));
    expect_same(sum, all);
  }
}

// Of those of some reaches alone; who they are is marked, and nobody else is touched.
TEST(BallBounds, OfAReachAreMarked) {
  const BoundedBalls balls(100);
  for (const Simd simd : widths())
    for (const auto& [begin, end] : kRanges) {
      std::vector<std::uint8_t> marks(100, 77);
      const BallBounds found =
          find_bounds_within(balls.span(), 1.0f, 2.5f, 9, marks.data(), simd, begin, end);
      BallBounds expected;
      for (int i = 0; i < 100; ++i) {
        const float reach = balls.reach[std::size_t(i)];
        const bool within = reach >= 1.0f && reach <= 2.5f;
        EXPECT_EQ(marks[std::size_t(i)], i < begin || i >= end ? 77 : within ? 9 : 0);
        if (within && i >= begin && i < end) expected.add(balls.span(), std::size_t(i));
      }
      expect_same(found, expected);
    }
}

TEST(BallBounds, BothEndsOfAReachCount) {
  BoundedBalls balls(20);
  std::fill(balls.reach.begin(), balls.reach.end(), 2.0f);
  std::vector<std::uint8_t> marks(20);
  EXPECT_EQ(find_bounds_within(balls.span(), 2.0f, 2.0f, 1, marks.data(), find_simd(), 0, 20).count, 20);
  const float above = std::nextafter(2.0f, 3.0f);
  EXPECT_EQ(find_bounds_within(balls.span(), above, 9.0f, 1, marks.data(), find_simd(), 0, 20).count, 0);
}

}  // namespace
}  // namespace lodestone
