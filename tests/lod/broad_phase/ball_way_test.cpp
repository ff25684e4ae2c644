#include "lod/broad_phase/ball_way.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone {
namespace {

// m: of the gap between two balls on their ways, at the nearest of a thousand moments.
double least_gap(const BallWay& a, const BallWay& b) {
  double least = 1e300;
  for (int i = -500; i <= 500; ++i) {
    const double at = i / 500.0;  // −1 to 1: from the step's beginning to its end
    least = std::min(least, (a.middle - b.middle + at * (a.half_way - b.half_way)).norm());
  }
  return least - a.radius - b.radius;
}

TEST(BallWay, ThoseThatPassNeverMeet) {
  RandomStream random(95, 0, 0);
  int passing = 0, meeting = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 common = 3.0 * random.direction();
    const auto way = [&] {
      return BallWay{2.0 * random.direction(), common + random.direction(), random.uniform(0.1, 1.0)};
    };
    const BallWay a = way(), b = way();
    const bool meet = least_gap(a, b) < 0.0;
    meeting += meet, passing += pass(a, b);
    EXPECT_FALSE(meet && pass(a, b)) << i;
  }
  EXPECT_GT(passing, 200);
  EXPECT_GT(meeting, 200);
}

TEST(BallWay, OfShortWaysNoneIsSaidToPass) {
  EXPECT_FALSE(pass({{0, 0, 0}, {0, 0, 0.9}, 1.0}, {{50, 0, 0}, {0, 0, 5}, 1.0}));
  EXPECT_TRUE(pass({{0, 0, 0}, {0, 0, 1.1}, 1.0}, {{50, 0, 0}, {0, 0, 5}, 1.0}));
}

}  // namespace
}  // namespace lodestone
