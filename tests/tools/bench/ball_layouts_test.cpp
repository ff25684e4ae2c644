#include "tools/bench/ball_layouts.h"

#include <gtest/gtest.h>

#include <set>

namespace lodestone {
namespace {

TEST(BallLayouts, EachHasItsNameAndAsManyBallsAsAsked) {
  std::set<std::string_view> names;
  for (const BallLayout& layout : ball_layouts()) {
    EXPECT_TRUE(names.insert(layout.name).second);
    EXPECT_FALSE(layout.what.empty());
    for (const int count : {1, 2, 100, 1000}) {
      const Balls balls = layout.make(count, 3);
      EXPECT_EQ(balls.size(), std::size_t(count)) << layout.name;
      EXPECT_EQ(balls.reach.size(), balls.size());
      for (std::size_t i = 0; i < balls.size(); ++i) {
        EXPECT_GT(balls.reach[i], 0.0f);
        EXPECT_TRUE(std::isfinite(balls.x[i] + balls.y[i] + balls.z[i]));
      }
    }
  }
  EXPECT_EQ(names.size(), 6U);
}

TEST(BallLayouts, AreOfTheirSeedAlone) {
  for (const BallLayout& layout : ball_layouts()) {
    const Balls a = layout.make(200, 3), b = layout.make(200, 3), other = layout.make(200, 4);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.reach, b.reach);
    EXPECT_NE(a.x, other.x) << layout.name;
  }
}

// Touching ones have a few neighbours each, sparse ones hardly any.
TEST(BallLayouts, AreAsDenseAsTheySay) {
  const auto neighbours = [](const Balls& balls) {
    int pairs = 0;
    for (std::size_t a = 0; a < balls.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) pairs += balls.meet(a, b);
    return 2.0 * pairs / double(balls.size());
  };
  for (const BallLayout& layout : ball_layouts()) {
    const double each = neighbours(layout.make(500, 1));
    if (layout.name == "sparse")
      EXPECT_LT(each, 0.1);
    else
      EXPECT_GT(each, 0.5) << layout.name;
    EXPECT_LT(each, 60.0) << layout.name;
  }
}

TEST(BallLayouts, MeetingIsOfBothReaches) {
  Balls balls;
  balls.add({0, 0, 0}, 1.0);
  balls.add({1.5, 0, 0}, 0.75);
  balls.add({0, 3, 0}, 1.9375);
  EXPECT_TRUE(balls.meet(0, 1));
  EXPECT_TRUE(balls.meet(1, 0));
  EXPECT_FALSE(balls.meet(0, 2));
}

TEST(BallLayouts, EachFliesItsWayAndBack) {
  const Balls start = ball_layouts()[0].make(50, 1);
  for (int steps = 0; steps <= 8; ++steps) {
    const Balls now = move(start, 6.0, steps, 5);
    const double expected = 0.1 * (steps <= 4 ? steps : 8 - steps);
    for (std::size_t i = 0; i < start.size(); ++i)
      EXPECT_NEAR(Vec3(now.x[i] - start.x[i], now.y[i] - start.y[i], now.z[i] - start.z[i]).norm(), expected,
                  1e-9);
    EXPECT_EQ(now.reach, start.reach);
  }
  EXPECT_NEAR(move(start, 6.0, 8 + 3, 5).x[0], move(start, 6.0, 3, 5).x[0], 1e-12);
}

}  // namespace
}  // namespace lodestone
