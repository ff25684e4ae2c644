#include "lod/manager/near_full.h"

#include <gtest/gtest.h>

#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

TEST(NearFull, FindsAllThatMayMeetAndFewBeyond) {
  RandomStream random(3, 0, 0);
  NearFull near;
  EXPECT_FALSE(near.made());
  near.begin();
  EXPECT_TRUE(near.made());
  struct Ball {
    Vec3 at;
    double reach;
  };
  std::vector<Ball> balls;
  for (std::uint32_t i = 0; i < 300; ++i) {
    balls.push_back({random.uniform(0, 10) * random.direction(), random.uniform(0.05, 1.0)});
    near.add(1000 + i, balls.back().at, balls.back().reach);
  }
  for (int i = 0; i < 200; ++i) {
    const Ball asked{random.uniform(0, 12) * random.direction(), i % 2 ? 0.1 : random.uniform(0.01, 2.0)};
    std::set<std::uint32_t> found;
    near.find(asked.at, asked.reach, [&](std::uint32_t body) { found.insert(body); });
    for (std::uint32_t b = 0; b < balls.size(); ++b) {
      const double gap = (balls[b].at - asked.at).norm() - balls[b].reach - asked.reach;
      if (gap < 0.0) {
        EXPECT_TRUE(found.contains(1000 + b)) << gap;
      } else if (gap > 4.0 && i % 2) {  // some cells; who asks for very much is shown all
        EXPECT_FALSE(found.contains(1000 + b)) << gap;
      }
    }
  }
}

TEST(NearFull, OneThatWasMovedIsFoundWhereItIs) {
  NearFull near;
  near.begin();
  near.add(7, {0, 0, 0}, 0.5);
  near.add(7, {50, 0, 0}, 0.5);
  int times = 0;
  near.find({50, 0, 0}, 0.1, [&](std::uint32_t body) { times += body == 7; });
  EXPECT_EQ(times, 1);
}

TEST(NearFull, WhatWasNotedHoldsNoMoreOnceItIsCleared) {
  NearFull near;
  near.begin();
  near.add(1, {0, 0, 0}, 1.0);
  near.clear();
  EXPECT_FALSE(near.made());
  near.begin();
  near.find({0, 0, 0}, 10.0, [](std::uint32_t body) { ADD_FAILURE() << body; });
}

}  // namespace
}  // namespace lodestone
