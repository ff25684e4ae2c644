// Changes of level: the hard cases T1 to T12 that need no contact between levels.
#include "lod/manager/transfer.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <set>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::transfer_test {
namespace {

using namespace testing;

RigidState random_state(std::uint32_t trial) {
  RandomStream random(7, trial, 0);
  return {3.0 * random.direction(), random.orientation(), 5.0 * random.direction(),
          20.0 * random.direction()};
}

double largest_speed(const Manager& manager, std::span<const BodyId> bodies) {
  double largest = 0.0;
  for (const BodyId body : bodies) largest = std::max(largest, manager.state(body).velocity.norm());
  return largest;
}

TEST(Transfer, T1MidAirBothWaysChangesNoBit) {
  Levels levels({}, {}, SignatureStore(coarse_signature, SignatureTiming::in_step));
  const auto shape = std::make_shared<const Shape>(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const RigidState given = random_state(trial);
    const std::uint32_t body = levels.bodies.add({.shape = shape, .state = given}, 1.3).index;
    place(levels, body, Rung(trial % 3));
    for (const Rung to : {Rung::support, Rung::full, Rung::tables, Rung::support, Rung::tables, Rung::full}) {
      if (levels.bodies.level(body).rung != to) transfer(levels, body, to);
      ASSERT_TRUE(same_bits(levels.state(body), given)) << "trial " << trial << ", to " << name_of(to);
    }
  }
}

// A body that changes level in flight lands where one that does not would, to the levels' own accuracy in
// flight.
TEST(Transfer, T1FlightGoesOnThroughChanges) {
  Manager manager{unmeasured()};
  const auto shape = box_shape({0.2, 0.3, 0.4});
  const RigidState start = at({0, 0, 0}, {1, 2, 3});
  const BodyId changing = add(manager, shape, start),
               full = add(manager, shape, at({50, 0, 0}, {1, 2, 3}), LevelChoice::full);
  for (int frame = 0; frame < 60; ++frame) {
    manager.set_level(changing, frame / 7 % 2 ? LevelChoice::full : LevelChoice::statistical);
    manager.step(kFrame);
  }
  EXPECT_LT((manager.state(changing).velocity - manager.state(full).velocity).norm(), 1e-12);
  EXPECT_LT((manager.state(changing).position + Vec3(50, 0, 0) - manager.state(full).position).norm(), 0.1);
}

TEST(Transfer, T2OverlappingPromotionIsPutOffAndCounted) {
  for (const double overlap : {0.05, 0.25, 0.5, 0.9, 1.0}) {
    Manager manager = on_floor();
    const auto shape = box_shape({0.4, 0.4, 0.4});
    add(manager, shape, at({0, 0, 0.2}), LevelChoice::full);
    const BodyId second = add(manager, shape, at({0.4 * (1.0 - overlap), 0, 0.2}), LevelChoice::statistical);
    manager.step(kFrame);
    manager.set_level(second, LevelChoice::full);
    manager.step(kFrame);
    EXPECT_EQ(manager.level(second), Level::statistical) << overlap;
    EXPECT_EQ(manager.report().counters.promotions_put_off, 1);
    EXPECT_EQ(manager.why(second), "support: its promotion waits until it overlaps no other body");
    manager.step(kFrame);
    EXPECT_EQ(manager.report().counters.promotions_put_off, 1) << "tried again too soon";
  }
}

TEST(Transfer, T2WhollyContainedBodyIsPutOffUntilItIsFree) {
  ManagerSettings settings = unmeasured();
  settings.gravity.setZero();
  Manager manager(settings);
  const BodyId large = add(manager, box_shape({2, 2, 2}), at({0, 0, 0}), LevelChoice::full);
  const BodyId small = add(manager, box_shape({0.1, 0.1, 0.1}), at({0.5, 0, 0}), LevelChoice::statistical);
  manager.step(kFrame);
  manager.set_level(small, LevelChoice::full);
  manager.step(kFrame);
  EXPECT_EQ(manager.level(small), Level::statistical);
  manager.set_state(large, at({10, 0, 0}));
  run(manager, 0.5);
  EXPECT_EQ(manager.level(small), Level::full);
}

TEST(Transfer, T2BodyDeepInTheGroundIsPutOff) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape({0.4, 0.4, 0.4}), at({0, 0, 0.1}), LevelChoice::statistical);
  view_from(manager, {0, 0, 0});
  manager.step(kFrame);
  manager.set_level(body, LevelChoice::automatic);
  manager.set_state(body, at({0, 0, 0.1}));
  manager.step(kFrame);
  EXPECT_EQ(manager.report().counters.promotions_put_off, 1);
  EXPECT_EQ(manager.report().promotions, 0);
}

// Bodies that the caller puts into each other, forced full, part at walking pace.
TEST(Transfer, T2ForcedOverlapPartsGently) {
  for (const double overlap : {0.05, 0.25, 0.5, 0.9}) {
    ManagerSettings settings = unmeasured();
    settings.gravity.setZero();
    Manager manager(settings);
    const auto shape = box_shape({0.4, 0.4, 0.4});
    const BodyId bodies[] = {add(manager, shape, at({0, 0, 0}), LevelChoice::full),
                             add(manager, shape, at({0.4 * (1.0 - overlap), 0.01, 0.02}), LevelChoice::full)};
    double fastest = 0.0;
    for (int i = 0; i < 120; ++i) {
      manager.step(kFrame);
      fastest = std::max(fastest, largest_speed(manager, bodies));
    }
    EXPECT_LE(fastest, 1.1) << overlap;
    EXPECT_GT((manager.state(bodies[0]).position - manager.state(bodies[1]).position).norm(), 0.39)
        << overlap;
  }
}

TEST(Transfer, T3RestingBodyNeitherPopsNorGainsEnergy) {
  for (const LevelChoice first : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager = on_floor();
    const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0.2001}), first);
    run(manager, 2.0);
    for (int change = 0; change < 6; ++change) {
      const RigidState before = manager.state(body);
      const double energy_before = energy(manager, body);
      manager.set_level(body,
                        manager.level(body) == Level::full ? LevelChoice::statistical : LevelChoice::full);
      for (int i = 0; i < 30; ++i) {
        manager.step(kFrame);
        EXPECT_LE((manager.state(body).position - before.position).norm(), 1e-3);
        EXPECT_LE(energy(manager, body) - energy_before, manager.mass(body) * kGravity * 1e-3);
      }
    }
  }
}

// A body that is awake takes its place among others on another rung: they look anew what holds them up.
TEST(Transfer, T5NeighborsWakeInTheFrameOfTheDemotion) {
  Manager manager = on_floor();
  const auto shape = box_shape({0.4, 0.4, 0.4});
  const BodyId lower = add(manager, shape, at({0, 0, 0.2}), LevelChoice::full),
               upper = add(manager, shape, at({0, 0, 0.6}), LevelChoice::full);
  const BodyId apart = add(manager, shape, at({3, 0, 0.2}), LevelChoice::full);
  run(manager, 2.0);
  ASSERT_TRUE(manager.asleep(lower) && manager.asleep(upper) && manager.asleep(apart));
  manager.add_force(lower, {1, 0, 0});
  manager.set_level(lower, LevelChoice::statistical);
  manager.step(kFrame);
  EXPECT_EQ(manager.level(lower), Level::statistical);
  EXPECT_FALSE(manager.asleep(upper));
  EXPECT_TRUE(manager.asleep(apart));
}

// It is where it was, so nobody needs to know: a pile changes rung body by body or whole, and sleeps on.
TEST(Transfer, T12ASleepingPileChangesRungAndSleepsOn) {
  Manager manager = on_floor();
  const auto shape = box_shape({0.4, 0.4, 0.4});
  std::vector<BodyId> pile;
  for (int i = 0; i < 12; ++i)
    pile.push_back(add(manager, shape, at({0.401 * (i % 2), 0.401 * (i / 2 % 2), 0.2 + 0.4 * (i / 4)}),
                       LevelChoice::full));
  run(manager, 3.0);
  ASSERT_EQ(manager.report().asleep, 12);
  std::vector<RigidState> before;
  for (const BodyId body : pile) before.push_back(manager.state(body));
  int changes = 0;
  for (const LevelChoice to : {LevelChoice::support, LevelChoice::full, LevelChoice::support})
    for (int one = 0; one < 12;
         one += changes < 12 ? 1 : 12) {  // first one after the other, then all at once
      for (int i = one; i < (changes < 12 ? one + 1 : 12); ++i) manager.set_level(pile[std::size_t(i)], to);
      manager.step(kFrame);
      changes += manager.report().promotions + manager.report().demotions;
      EXPECT_EQ(manager.report().asleep, 12) << "change " << changes;
    }
  EXPECT_EQ(changes, 36);
  run(manager, 0.5);
  EXPECT_EQ(manager.report().asleep, 12);
  for (std::size_t i = 0; i < pile.size(); ++i)
    EXPECT_TRUE(same_bits(manager.state(pile[i]), before[i])) << i;
}

TEST(Transfer, T5WhatRestedOnARemovedBodyFalls) {
  for (const LevelChoice below : {LevelChoice::full, LevelChoice::statistical})
    for (const LevelChoice above : {LevelChoice::full, LevelChoice::statistical}) {
      Manager manager = on_floor();
      const auto shape = box_shape({0.4, 0.4, 0.4});
      const BodyId lower = add(manager, shape, at({0, 0, 0.2}), below),
                   upper = add(manager, shape, at({0, 0, 0.6}), above);
      run(manager, 2.0);
      manager.remove_body(lower);
      run(manager, 1.0);
      EXPECT_NEAR(manager.state(upper).position.z(), 0.2, 0.01) << int(below) << int(above);
    }
}

TEST(Transfer, T7CameraAboutTheThresholdKeepsEnergy) {
  ManagerSettings settings = unmeasured();
  settings.policy.hysteresis = 0.0;  // only the dwell holds changes back
  settings.gravity.setZero();
  Manager manager(settings);
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}),
                          at({0, 0, 0}, Vec3::Zero(), {3, 0, 0}));  // about the axis of greatest inertia
  const double radius = manager.shape(body).radius;
  view_from(manager, {4.2 + radius, 0, 0});
  manager.step(kFrame);
  const double energy_before = energy(manager, body);
  int changes = 0, frames_since = 1000;
  for (int frame = 0; frame < 3600; ++frame, ++frames_since) {
    view_from(manager, {radius + 4.0 * (1.0 + 0.01 * ((frame / 3) % 2 ? 1 : -1)), 0, 0});
    manager.step(kFrame);
    if (manager.report().promotions + manager.report().demotions == 0) continue;
    EXPECT_GE(frames_since, settings.policy.min_dwell_frames);
    frames_since = 0;
    ++changes;
  }
  EXPECT_GT(changes, 10);
  EXPECT_NEAR(energy(manager, body), energy_before, 0.01 * energy_before);
}

// In the step in which one became full nothing was known to hold it up, and what lay on it fell with it; on a
// kinematic body so for several steps, by up to 10 cm.
TEST(Transfer, WhatLiesOnOneThatBecomesFullLiesStill) {
  constexpr double kSide = 0.3;
  for (const bool on_kinematic : {false, true}) {
    Manager manager(unmeasured());
    BodyProperties kinematic;
    kinematic.kinematic = true;
    if (on_kinematic)
      manager.add_body({.shape = box_shape({6, 6, 0.4}),
                        .state = at({0, 0, -0.2}),
                        .level = LevelChoice::full,
                        .properties = kinematic});
    else
      manager.add_plane(Vec3::UnitZ(), 0.0);
    std::vector<BodyId> stack;
    for (int i = 0; i < 3; ++i)
      stack.push_back(
          add(manager, box_shape({kSide, kSide, kSide}), at({0, 0, kSide * (i + 0.5)}), LevelChoice::full));
    RandomStream random(7, 0, 0);
    for (int frame = 0; frame < 300; ++frame) {
      if (frame % 7 == 6)
        manager.set_level(stack[std::size_t(random.uniform(0.0, 3.0))],
                          random.uniform(0.0, 1.0) < 0.5 ? LevelChoice::full : LevelChoice::support);
      for (const BodyId body : stack) manager.wake(body);
      manager.step(kFrame);
      for (int i = 0; i < 3; ++i)
        ASSERT_NEAR((manager.state(stack[std::size_t(i)]).position - Vec3(0, 0, kSide * (i + 0.5))).norm(),
                    0.0, 1.5e-3)
            << on_kinematic << ", frame " << frame << ", cube " << i;
    }
  }
}

// It was held back as if it had to part from what it lay on: its carrier went on under it.
TEST(Transfer, WhoIsCarriedGoesOnWithItsCarrier) {
  constexpr double kSpeed = 0.3;  // m/s
  for (const bool by_body : {false, true}) {
    Manager manager(unmeasured());
    BodyProperties kinematic;
    kinematic.kinematic = true;
    const auto where = [&](int frame) { return at({kSpeed * frame * kFrame, 0, -0.2}, {kSpeed, 0, 0}); };
    BodyId body;
    GroundId ground;
    if (by_body)
      body = manager.add_body({.shape = box_shape({6, 6, 0.4}),
                               .state = where(0),
                               .level = LevelChoice::full,
                               .properties = kinematic});
    else
      ground = manager.add_static_box({6, 6, 0.4}, where(0).position, Quat::Identity());
    const BodyId crate =
        add(manager, box_shape({0.3, 0.3, 0.3}), at({0, 0, 0.15}, {kSpeed, 0, 0}), LevelChoice::support);
    for (int frame = 0; frame < 60; ++frame) {
      if (by_body)
        manager.set_state(body, where(frame));
      else
        manager.move_ground(ground, where(frame));
      if (frame == 30) manager.set_level(crate, LevelChoice::full);
      manager.step(kFrame);
      ASSERT_NEAR(manager.state(crate).position.x(), where(frame + 1).position.x(), 1e-3)
          << by_body << ", frame " << frame;
    }
    EXPECT_EQ(manager.level(crate), Level::full);
  }
}

struct Teleport {
  std::vector<int> promoted;  // in order of frames, then of bodies
  int most_in_a_frame = 0;
  std::uint64_t hash = 0;
};

Teleport teleport_to_a_field_of_bodies() {
  ManagerSettings settings = unmeasured({.policy = DistancePolicy{100.0}});
  settings.gravity.setZero();
  Manager manager(settings);
  const auto shape = sphere_shape(0.1);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 1000; ++i)
    bodies.push_back(add(manager, shape, at({0.5 * (i % 32), 0.5 * (i / 32), 0})));
  manager.step(kFrame);
  view_from(manager, {3, 4, 0});
  Teleport seen;
  std::set<int> full;
  for (int frame = 0; frame < 260; ++frame) {
    manager.step(kFrame);
    seen.most_in_a_frame = std::max(seen.most_in_a_frame, manager.report().promotions);
    for (int i = 0; i < 1000; ++i)
      if (manager.level(bodies[i]) == Level::full && full.insert(i).second) seen.promoted.push_back(i);
  }
  seen.hash = manager.state_hash();
  return seen;
}

TEST(Transfer, T8ThousandPromotionsQueueInTheSameOrderEveryRun) {
  const Teleport first = teleport_to_a_field_of_bodies(), second = teleport_to_a_field_of_bodies();
  EXPECT_EQ(first.most_in_a_frame, 4);
  EXPECT_EQ(first.promoted.size(), 1000u);
  const int nearest = 8 * 32 + 6;
  EXPECT_EQ((std::vector<int>(first.promoted.begin(), first.promoted.begin() + 4)),
            (std::vector{nearest - 32, nearest - 1, nearest, nearest + 1}));
  EXPECT_EQ(first.promoted, second.promoted);
  EXPECT_EQ(first.hash, second.hash);
}

std::int64_t allocated_bytes() {
  const auto heap = mallinfo2();
  return std::int64_t(heap.uordblks + heap.hblkhd);
}

TEST(Transfer, T9ManyCyclesDoNotGrow) {
  Levels levels({}, {}, SignatureStore(coarse_signature, SignatureTiming::in_step));
  const auto shape = box_shape({0.2, 0.3, 0.4});
  const std::uint32_t body = levels.bodies.add({.shape = shape, .state = at({0, 0, 0})}, 1.0).index;
  place(levels, body, Rung::full);
  const auto cycle = [&](int i) {
    transfer(levels, body, Rung(i % 3));
    levels.rung_changes.clear();  // as every step does
  };
  for (int i = 0; i < 1000; ++i) cycle(i);
  const std::int64_t before = allocated_bytes();
  for (int i = 1000; i < 21'000; ++i) cycle(i);
  EXPECT_LT(allocated_bytes() - before, 20'000);  // less than a byte of a cycle
  EXPECT_EQ(levels.full.members().size(), 1u);
}

TEST(Transfer, T11MeasuredBudgetIsKeptByDemotingAtOnce) {
  Manager manager{unmeasured({.policy = BudgetPolicy{1e9}, .max_transitions_per_frame = 1000})};
  const auto shape = sphere_shape(0.1);
  for (int i = 0; i < 50; ++i) add(manager, shape, at({1.0 * i, 0, 0}));
  view_from(manager, {0, 0, 0});
  manager.step(kFrame);
  EXPECT_EQ(manager.report().full, 50);

  Manager poor{unmeasured({.policy = BudgetPolicy{0.0}})};
  for (int i = 0; i < 50; ++i) add(poor, shape, at({1.0 * i, 0, 0}));
  view_from(poor, {0, 0, 0});
  run(poor, 1.0);
  EXPECT_EQ(poor.report().full, 0);
}

TEST(Transfer, T12SleepIsCarried) {
  for (const LevelChoice first : {LevelChoice::full, LevelChoice::statistical}) {
    Manager manager = on_floor();
    const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 0.2}), first);
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(body));
    const RigidState before = manager.state(body);
    manager.set_level(body, first == LevelChoice::full ? LevelChoice::statistical : LevelChoice::full);
    manager.step(kFrame);
    EXPECT_TRUE(manager.asleep(body));
    EXPECT_TRUE(same_bits(manager.state(body), before));
  }
}

// The spheres of two crates overlap before their hulls do: `support` takes them from there.
TEST(Transfer, WhatOverlapsOnItsWayUpFromTablesTakesSupportFirst) {
  ManagerSettings settings =
      unmeasured({.policy = DistancePolicy{.full_within = 4.0, .support_within = 6.0}});
  settings.gravity.setZero();
  settings.signatures = coarse_signature;
  Manager manager(settings);
  const auto shape = box_shape({0.4, 0.4, 0.4});
  add(manager, shape, at({0, 0, 0}), LevelChoice::full);
  const BodyId inside = add(manager, shape, at({0.2, 0, 0}));
  view_from(manager, {20, 0, 0});
  manager.step(kFrame);
  ASSERT_EQ(manager.rung(inside), Rung::tables) << manager.why(inside);
  view_from(manager, {0, 0, 0});
  manager.set_state(inside, at({0.2, 0, 0}));
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(inside), Rung::support) << manager.why(inside);
  EXPECT_EQ(manager.explain(inside).rule, Rule::overlap_put_off);
  EXPECT_EQ(manager.report().promotions, 1);
  EXPECT_EQ(manager.report().counters.promotions_put_off, 0);
}

TEST(Transfer, T12PendingForceIsCarriedAndActsOnce) {
  for (const LevelChoice first : {LevelChoice::full, LevelChoice::statistical}) {
    ManagerSettings settings = unmeasured();
    settings.gravity.setZero();
    Manager manager(settings);
    const BodyId body =
        manager.add_body({.shape = sphere_shape(0.1), .state = at({0, 0, 0}), .mass = 2.0, .level = first});
    manager.step(kFrame);
    manager.add_force(body, {24, 0, 0}, {0, 0, 0.24});
    manager.set_level(body, first == LevelChoice::full ? LevelChoice::statistical : LevelChoice::full);
    manager.step(kFrame);
    manager.step(kFrame);
    EXPECT_NEAR(manager.state(body).velocity.x(), 12 * kFrame, 1e-12);
    EXPECT_NEAR(manager.state(body).angular_velocity.z(), 0.24 * kFrame / (2.0 * 0.4 * 0.01), 1e-6);
  }
}

// At the frame of an impact: the rebound is that of one impact, not of two.
TEST(Transfer, T12ChangeAtTheFrameOfAnImpact) {
  for (int offset = -2; offset <= 2; ++offset)
    for (const LevelChoice first : {LevelChoice::full, LevelChoice::statistical}) {
      Manager manager = on_floor();
      const BodyId ball = add(manager, sphere_shape(0.1), at({0, 0, 0.6}, {0, 0, -2.0}), first);
      const int impact_frame = 11;  // .5 m at 2 m/s and gravity: .187 s
      double fastest_up = 0.0;
      for (int frame = 0; frame < 30; ++frame) {
        if (frame == impact_frame + offset)
          manager.set_level(ball, first == LevelChoice::full ? LevelChoice::statistical : LevelChoice::full);
        manager.step(kFrame);
        fastest_up = std::max(fastest_up, manager.state(ball).velocity.z());
      }
      const double impact_speed = std::sqrt(4.0 + 2 * kGravity * 0.5);
      EXPECT_NEAR(fastest_up, 0.4 * impact_speed, 0.15) << "offset " << offset;
    }
}

// A promotion waits until what could throw the body is out of the way, and for nothing else.
TEST(Transfer, WhatCannotPushABodyDoesNotKeepItFromFull) {
  const auto cube = box_shape({0.3, 0.3, 0.3});
  const auto goes_up = [](Manager& manager, BodyId body) {
    manager.set_level(body, LevelChoice::full);
    manager.step(kFrame);
    return manager.rung(body) == Rung::full;
  };
  for (const bool by_filter : {true, false}) {
    ManagerSettings settings = unmeasured();
    if (by_filter) settings.pair_filter = [](BodyId, BodyId) { return false; };
    Manager manager = on_floor(settings);
    const BodyProperties ghost{.category = 2, .collide = by_filter ? ~0u : 1u};
    std::vector<BodyId> bodies;
    for (const double x : {0.0, 0.1})
      bodies.push_back(manager.add_body({.shape = cube,
                                         .state = testing::at({x, 0, 0.15}),
                                         .level = LevelChoice::support,
                                         .properties = ghost}));
    run(manager, 0.1);
    for (const BodyId body : bodies) EXPECT_TRUE(goes_up(manager, body)) << by_filter;
  }
  Manager manager = on_floor();
  const BodyId slab = manager.add_body(
      {.shape = box_shape({2, 2, 0.2}), .level = LevelChoice::support, .properties = {.kinematic = true}});
  manager.step(kFrame);
  EXPECT_TRUE(goes_up(manager, slab));
}

}  // namespace
}  // namespace lodestone::transfer_test
