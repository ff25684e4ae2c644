#include "lod/manager/share_by_error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodestone {
namespace {

const StepOverhead kFree;

/// Costs 0, 1 and 10; errs by so many pixels.
LevelCandidate body(float tables_px, float support_px, float full_px, Rung rung = Rung::tables) {
  static int count = 0;
  LevelCandidate c{.position = Vec3(100.0 * ++count, 0, 0), .radius = 0.1, .cost = {0, 1, 10}, .rung = rung};
  c.error = {tables_px, support_px, full_px};
  return c;
}

std::vector<Rung> share(const std::vector<LevelCandidate>& bodies, double keep, double grow,
                        ErrorShareLimits limits = {
                            .most_full = 1000, .most_support = 1000, .hysteresis = 0.1}) {
  return share_by_error(bodies, FullBill(bodies, kFree), {keep, grow}, limits);
}
std::vector<Rung> share(const std::vector<LevelCandidate>& bodies, double room) {
  return share(bodies, room, room);
}

TEST(ShareByError, SpendsWhereItSavesMost) {
  const std::vector bodies{body(10, 5, 4), body(100, 50, 40), body(30, 15, 12)};
  EXPECT_EQ(share(bodies, 1.0), (std::vector{Rung::tables, Rung::support, Rung::tables}));
  EXPECT_EQ(share(bodies, 2.0), (std::vector{Rung::tables, Rung::support, Rung::support}));
  EXPECT_EQ(share(bodies, 3.0), (std::vector{Rung::support, Rung::support, Rung::support}));
  EXPECT_EQ(share(bodies, 12.0), (std::vector{Rung::support, Rung::full,
                                              Rung::support}));  // 9 more for the one, which saves 10 px
}

TEST(ShareByError, WhatSavesNothingIsNotBought) {
  EXPECT_EQ(share({body(10, 5, 5)}, 100.0), std::vector{Rung::support});
  EXPECT_EQ(share({body(0, 0, 0, Rung::full)}, 100.0), std::vector{Rung::tables});
}

TEST(ShareByError, AStepThatIsOnlyWorthItAsAWholeIsOne) {
  EXPECT_EQ(share({body(100, 99, 0)}, 10.0), std::vector{Rung::full});
  EXPECT_EQ(share({body(100, 99, 0)}, 9.0), std::vector{Rung::tables});
}

TEST(ShareByError, NoMoreThanTheLimits) {
  const std::vector bodies{body(100, 50, 0), body(90, 45, 0), body(80, 40, 0)};
  const auto rungs = share(bodies, 1e3, 1e3, {.most_full = 1, .most_support = 1, .hysteresis = 0.1});
  EXPECT_EQ(rungs, (std::vector{Rung::full, Rung::support, Rung::tables}));
}

// It is paid already, and the other would have to pay it, too.
TEST(ShareByError, WhatComingToARungCostIsNoReasonToLeaveIt) {
  LevelCandidate arriving = body(10, 5, 1, Rung::support);
  arriving.passing = 4;
  arriving.cost[std::size_t(Rung::support)] += arriving.passing;
  EXPECT_EQ(share({body(10, 5, 1), arriving}, 5.0), (std::vector{Rung::tables, Rung::support}));
}

TEST(ShareByError, OfTwoAlikeTheOneThatIsUpStaysUp) {
  EXPECT_EQ(share({body(10, 5, 1), body(10, 5, 1, Rung::support)}, 1.0),
            (std::vector{Rung::tables, Rung::support}));
  // Room to keep is not room to grow.
  EXPECT_EQ(share({body(10, 5, 1, Rung::support), body(10, 5, 1)}, 2.0, 1.0),
            (std::vector{Rung::support, Rung::tables}));
}

// Against all ways to share, for a few bodies: greedy is within the dearest step of the best.
TEST(ShareByError, IsNearTheBestShare) {
  const std::vector bodies{body(10, 4, 1), body(23, 9, 2), body(31, 17, 3), body(7, 6, 5), body(50, 21, 20)};
  for (double room = 0; room < 50; room += 1.7) {
    const auto rungs = share(bodies, room);
    double cost = 0, error = 0, best = 1e9, dearest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      cost += bodies[i].cost_at(rungs[i]), error += bodies[i].error_at(rungs[i]);
      dearest = std::max(dearest, bodies[i].error_at(Rung::tables) - bodies[i].error_at(Rung::full));
    }
    EXPECT_LE(cost, room);
    for (int code = 0; code < 243; ++code) {
      double c = 0, e = 0;
      for (int i = 0, rest = code; i < 5; ++i, rest /= 3)
        c += bodies[std::size_t(i)].cost_at(Rung(rest % 3)),
            e += bodies[std::size_t(i)].error_at(Rung(rest % 3));
      if (c <= room) best = std::min(best, e);
    }
    EXPECT_LE(error, best + dearest) << room;
  }
}

}  // namespace
}  // namespace lodestone
