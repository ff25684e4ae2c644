#include "lod/manager/share_of_full.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"

namespace lodestone {
namespace {

std::vector<LevelCandidate> draw_bodies(std::uint32_t seed, int count, double within) {
  RandomStream random(61, seed, 0);
  std::vector<LevelCandidate> bodies;
  for (int i = 0; i < count; ++i) {
    LevelCandidate c;
    c.position = within * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    c.radius = random.uniform(0.1, 0.5);
    c.cost = {0.1f, 1.0f, float(random.uniform(5.0, 20.0))};
    c.mesh = float(random.uniform(0.1, 1.0));
    c.asleep = random.uniform() < 0.4;
    bodies.push_back(c);
  }
  return bodies;
}

std::vector<Ranked> rank(const std::vector<LevelCandidate>& bodies) {
  std::vector<Ranked> ranked;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    ranked.push_back({.distance = bodies[i].position.norm(), .index = std::int32_t(i), .to = Rung::full});
  return ranked;
}

const StepOverhead kNoPairs{};
const StepOverhead kPairs{.pair = 3.0, .spike = 7.0};

double total_of(const std::vector<LevelCandidate>& bodies, const StepOverhead& overhead,
                const std::vector<std::size_t>& order) {
  FullBill bill(bodies, overhead);
  for (const std::size_t i : order) bill.add(bodies[i]);
  return bill.total();
}

TEST(FullBill, IsTheSumOfTheRaisesWhereNobodyMeets) {
  std::vector<LevelCandidate> bodies = draw_bodies(1, 30, 1.0);
  double sum = 0.0;
  FullBill bill(bodies, kPairs);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].position = Vec3(2.0 * double(i), 0, 0);
    EXPECT_EQ(bill.price_of_pairs(bodies[i]), 0.0);
    bill.add(bodies[i]);
    sum += double(bodies[i].cost[2]) - double(bodies[i].cost[0]);
  }
  EXPECT_NEAR(bill.total(), sum, 1e-4);
}

// Whoever is added first: the same sum, and never less than before.
TEST(FullBill, DoesNotHangOnTheOrder) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const auto bodies = draw_bodies(seed, 40, 1.0);
    std::vector<std::size_t> order(bodies.size()), back;
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    back.assign(order.rbegin(), order.rend());
    const double there = total_of(bodies, kPairs, order), again = total_of(bodies, kPairs, back);
    EXPECT_NEAR(there, again, 1e-9 * there);
    EXPECT_GT(there, total_of(bodies, kNoPairs, order));
  }
}

// In a heap: the bill's pairs are those that each two of its bodies make by themselves.
TEST(FullBill, PairsAreThoseOfEachTwo) {
  const StepOverhead pairs_alone{.pair = 1.0};
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const auto bodies = draw_bodies(seed, 30, 1.0);
    double each_two = 0.0, alone = 0.0;
    for (std::size_t a = 0; a < bodies.size(); ++a) {
      alone += raise(bodies[a], Rung::full);
      for (std::size_t b = 0; b < a; ++b) {
        FullBill two(bodies, pairs_alone);
        two.add(bodies[b]);
        each_two += two.price_of_pairs(bodies[a]);
      }
    }
    std::vector<std::size_t> order(bodies.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    EXPECT_NEAR(total_of(bodies, pairs_alone, order), alone + each_two, 1e-6);
    EXPECT_GT(each_two, 0.0);
  }
}

TEST(FullBill, SleepersAreChargedHalf) {
  auto bodies = draw_bodies(3, 2, 0.01);
  const StepOverhead pairs_alone{.pair = 1.0};
  double price[2];
  for (const bool asleep : {false, true}) {
    bodies[0].asleep = bodies[1].asleep = asleep;
    FullBill bill(bodies, pairs_alone);
    bill.add(bodies[0]);
    price[asleep] = bill.price_of_pairs(bodies[1]);
  }
  EXPECT_NEAR(price[1], kChargeOfSleepers * price[0], 1e-12);
  EXPECT_GT(price[1], 0.0);
}

// Without pairs: the nearest, until the next does not fit.
TEST(ShareFull, TakesTheNearestUntilOneDoesNotFit) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const auto bodies = draw_bodies(seed, 50, 10.0);
    const double room = 30.0 * (1 + seed);
    const std::int64_t most = seed % 3 == 0 ? 5 : 1000;
    std::vector<Ranked> in_order = rank(bodies);
    std::ranges::sort(in_order, nearer);
    std::vector<std::int32_t> expected;
    double left = room;
    for (const Ranked& next : in_order) {
      const double price = raise(bodies[std::size_t(next.index)], Rung::full);
      if (price > left || std::int64_t(expected.size()) == most) break;
      expected.push_back(next.index);
      left -= price;
    }
    const ShareOfFull share = share_full(bodies, rank(bodies), FullBill(bodies, kNoPairs), room, most);
    std::vector<std::int32_t> taken;
    for (const Ranked& one : share.taken) taken.push_back(one.index);
    EXPECT_EQ(taken, expected) << seed;
    EXPECT_EQ(share.taken.size() + share.rest.size(), bodies.size());
    EXPECT_NEAR(share.used, room - left, 1e-3);
  }
}

// With pairs: what is taken fits, each of its members once, and one that was passed over would not have fit.
TEST(ShareFull, WhatIsTakenFitsWithItsPairs) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const auto bodies = draw_bodies(seed, 60, 1.2);
    const double room = 60.0 * (1 + seed);
    const ShareOfFull share = share_full(bodies, rank(bodies), FullBill(bodies, kPairs), room, kUnlimited);
    FullBill bill(bodies, kPairs);
    std::vector<bool> seen(bodies.size(), false);
    double last = 0.0;
    for (const Ranked& one : share.taken) {
      EXPECT_LE(last, one.distance);
      last = one.distance;
      EXPECT_FALSE(seen[std::size_t(one.index)]);
      seen[std::size_t(one.index)] = true;
      bill.add(bodies[std::size_t(one.index)]);
    }
    EXPECT_LE(bill.total(), room * (1 + 1e-12));
    EXPECT_NEAR(share.used, bill.total(), 1e-9 * room);
    for (const Ranked& one : share.rest) EXPECT_FALSE(seen[std::size_t(one.index)]);
    EXPECT_EQ(share.taken.size() + share.rest.size(), bodies.size());
  }
}

TEST(ShareFull, ReachIsWhereNobodyWasLookedAt) {
  const auto bodies = draw_bodies(9, 30, 10.0);
  EXPECT_EQ(share_full(bodies, rank(bodies), FullBill(bodies, kNoPairs), 1e9, kUnlimited).reach, kInfinity);
  const ShareOfFull none = share_full(bodies, rank(bodies), FullBill(bodies, kNoPairs), 0.0, kUnlimited);
  std::vector<Ranked> in_order = rank(bodies);
  std::ranges::sort(in_order, nearer);
  EXPECT_TRUE(none.taken.empty());
  EXPECT_EQ(none.reach, in_order[0].distance);
  const ShareOfFull all_but_most = share_full(bodies, rank(bodies), FullBill(bodies, kNoPairs), 1e9, 30);
  EXPECT_EQ(all_but_most.taken.size(), 30U);
  EXPECT_EQ(all_but_most.reach, in_order[29].distance);
}

// At the same distance the lower index goes first, however they are handed over.
TEST(ShareFull, TiesGoToTheLowerIndex) {
  std::vector<LevelCandidate> bodies(6);
  for (LevelCandidate& c : bodies) c.cost = {0, 0, 10}, c.position = {3, 0, 0}, c.mesh = 0.0f;
  std::vector<Ranked> ranked = rank(bodies);
  std::ranges::reverse(ranked);
  const ShareOfFull share = share_full(bodies, ranked, FullBill(bodies, kNoPairs), 30.0, kUnlimited);
  ASSERT_EQ(share.taken.size(), 3U);
  for (std::int32_t i = 0; i < 3; ++i) EXPECT_EQ(share.taken[std::size_t(i)].index, i);
}

TEST(MayBeFullNow, WaitsForItsDwell) {
  LevelCandidate c{.rung = Rung::support};
  c.dwell_left = 1;
  EXPECT_FALSE(may_be_full_now(c));
  c.dwell_left = 0;
  EXPECT_TRUE(may_be_full_now(c));
  c.put_off = true;
  EXPECT_FALSE(may_be_full_now(c));
  c.newcomer = true;
  EXPECT_TRUE(may_be_full_now(c));
  c = LevelCandidate{.rung = Rung::full};
  c.dwell_left = 30, c.put_off = true;
  EXPECT_TRUE(may_be_full_now(c));
  c.open = {Rung::tables, Rung::support};
  EXPECT_FALSE(may_be_full_now(c));
  c.open = {Rung::full};
  EXPECT_FALSE(may_be_full_now(c));  // it is, without a choice
}

}  // namespace
}  // namespace lodestone
