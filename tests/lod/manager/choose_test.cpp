// The policy on a whole scene, against what it says when it is asked about all bodies at once.
#include <gtest/gtest.h>

#include <map>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

PolicySettings at_once(const decltype(PolicySettings::policy)& policy) {
  PolicySettings settings;
  settings.policy = policy, settings.min_dwell_frames = 0, settings.max_transitions_per_frame = 1000;
  settings.hysteresis = 0.0;
  return settings;
}

Manager grid_in_space(const PolicySettings& policy, int side, std::vector<BodyId>& bodies) {
  ManagerSettings settings = unmeasured(policy);
  settings.gravity = Vec3::Zero();
  Manager manager(settings);
  const auto box = box_shape({0.2, 0.2, 0.2});
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y) bodies.push_back(add(manager, box, testing::at({1.0 * x, 1.0 * y, 0})));
  return manager;
}

// By distance: after each move of the viewpoints, exactly those within are full.
TEST(Choose, FullAreThoseWithin) {
  std::vector<BodyId> bodies;
  Manager manager = grid_in_space(at_once(DistancePolicy{3.0}), 12, bodies);
  RandomStream random(68, 0, 0);
  for (int move = 0; move < 12; ++move) {
    std::vector<Vec3> eyes;
    for (int i = 0; i < 1 + move % 3; ++i)
      eyes.emplace_back(random.uniform(-3, 14), random.uniform(-3, 14), 1.0);
    manager.set_viewpoints(eyes);
    manager.step(kFrame), manager.step(kFrame);
    for (const BodyId body : bodies) {
      double gap = 1e9;
      for (const Vec3& eye : eyes)
        gap = std::min(gap, (manager.state(body).position - eye).norm() - manager.shape(body).radius);
      if (std::abs(gap - 3.0) < 1e-6) continue;
      EXPECT_EQ(manager.rung(body) == Rung::full, gap < 3.0) << gap;
      EXPECT_NEAR(manager.explain(body).distance_m, std::max(0.0, gap), 1e-9);
      EXPECT_EQ(manager.explain(body).rule, gap < 3.0 ? Rule::near : Rule::far);
    }
  }
}

// Twice as important: full at twice the distance.
TEST(Choose, ImportanceScalesTheDistance) {
  std::vector<BodyId> bodies;
  Manager manager = grid_in_space(at_once(DistancePolicy{2.0}), 8, bodies);
  for (std::size_t i = 0; i < bodies.size(); i += 2) manager.set_importance(bodies[i], 2.0);
  view_from(manager, {0, 0, 0});
  manager.step(kFrame), manager.step(kFrame);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double gap = manager.state(bodies[i]).position.norm() - manager.shape(bodies[i]).radius;
    EXPECT_EQ(manager.rung(bodies[i]) == Rung::full, gap < (i % 2 == 0 ? 4.0 : 2.0));
  }
}

TEST(Choose, SignificanceIsCutToItsRangeAndScalesAlike) {
  for (const auto& [value, expected] : {std::pair(0.5, 0.5), {7.0, 1.0}, {1.0, 1.0}}) {
    PolicySettings policy = at_once(DistancePolicy{4.0});
    policy.significance = [value = value](BodyId) { return value; };
    std::vector<BodyId> bodies;
    Manager manager = grid_in_space(policy, 7, bodies);
    view_from(manager, {0, 0, 0});
    manager.step(kFrame), manager.step(kFrame);
    for (const BodyId body : bodies) {
      const double gap = manager.state(body).position.norm() - manager.shape(body).radius;
      EXPECT_EQ(manager.rung(body) == Rung::full, gap < 4.0 * expected) << value << ' ' << gap;
    }
  }
}

TEST(Choose, CapsAreNeverExceededAndTheNearestGoFirst) {
  PolicySettings policy = at_once(DistancePolicy{5.0});
  policy.most_full = 7;
  std::vector<BodyId> bodies;
  Manager manager = grid_in_space(policy, 8, bodies);
  for (const Vec3& eye : {Vec3(0, 0, 0.5), Vec3(7, 7, 0.5), Vec3(3, 4, 0.5)}) {
    view_from(manager, eye);
    for (int i = 0; i < 3; ++i) {
      manager.step(kFrame);
      EXPECT_LE(manager.report().full, 7);
    }
    EXPECT_EQ(manager.report().full, 7);
    double farthest_full = 0.0, nearest_other = 1e9;
    for (const BodyId body : bodies) {
      const double d = (manager.state(body).position - eye).norm();
      if (manager.rung(body) == Rung::full)
        farthest_full = std::max(farthest_full, d);
      else
        nearest_other = std::min(nearest_other, d);
    }
    EXPECT_LE(farthest_full, nearest_other + 1e-9);
  }
}

// The camera goes from the one to the other, whose places they have to exchange.
TEST(Choose, WhoIsFarMakesRoomForWhoIsNearThoughBothRungsAreTaken) {
  for (const bool budget : {false, true})
    for (const bool sleeping : {false, true}) {
      PolicySettings policy = at_once(DistancePolicy{50.0, 100.0});
      if (budget) policy.policy = WorkPolicy{1e6};
      policy.most_full = policy.most_support = 1;
      Manager manager = on_floor({.sleeping = sleeping, .policy = policy, .signatures = coarse_signature});
      const auto box = box_shape({0.2, 0.3, 0.4});
      const BodyId here = add(manager, box, testing::at({0, 0, 0.2})),
                   there = add(manager, box, testing::at({20, 0, 0.2}));
      view_from(manager, {0, 0, 1});
      run(manager, 2.0);
      EXPECT_EQ(manager.rung(here), Rung::full);
      EXPECT_EQ(manager.rung(there), Rung::support);
      view_from(manager, {20, 0, 1});
      run(manager, 0.1);
      EXPECT_EQ(manager.rung(there), Rung::full) << budget << sleeping << manager.why(there);
      EXPECT_EQ(manager.rung(here), Rung::support) << budget << sleeping << manager.why(here);
    }
}

// A few changes a frame, and each body no sooner again than its dwell; counted against a list of our own.
TEST(Choose, ChangesKeepTheDwellAndTheCap) {
  PolicySettings policy = at_once(DistancePolicy{3.0});
  policy.max_transitions_per_frame = 3, policy.min_dwell_frames = 10;
  std::vector<BodyId> bodies;
  Manager manager = grid_in_space(policy, 8, bodies);
  view_from(manager, {100, 0, 0});
  manager.step(kFrame);
  std::map<std::uint32_t, int> changed_at;
  RandomStream random(69, 0, 0);
  int changes = 0;
  for (int step = 1; step < 120; ++step) {
    if (step % 7 == 0) view_from(manager, {random.uniform(0, 8), random.uniform(0, 8), 0.5});
    manager.step(kFrame);
    EXPECT_LE(manager.rung_changes().size(), 3U);
    EXPECT_EQ(int(manager.rung_changes().size()), manager.report().promotions + manager.report().demotions);
    for (const RungChange& change : manager.rung_changes()) {
      ++changes;
      EXPECT_NE(change.from, change.to);
      EXPECT_EQ(manager.rung(change.body), change.to);
      if (changed_at.contains(change.body.index)) {
        EXPECT_GE(step - changed_at[change.body.index], 10);
      }
      changed_at[change.body.index] = step;
    }
  }
  EXPECT_GT(changes, 40);
}

// A budget of work: never more full than it pays for, none left over where there is room, the same each run.
TEST(Choose, AWorkBudgetIsFilledAndKept) {
  std::vector<int> full[2];
  for (auto& counts : full) {
    for (const double work : {0.0, 300.0, 1000.0, 1e6}) {
      std::vector<BodyId> bodies;
      Manager manager = grid_in_space(at_once(WorkPolicy{work}), 6, bodies);
      view_from(manager, {0, 0, 1});
      for (int i = 0; i < 4; ++i) manager.step(kFrame);
      counts.push_back(manager.report().full);
      if (work > 0.0 && work < 1e6) {
        double predicted = 0.0;
        for (const RungCost& cost : manager.report().cost) predicted += cost.work;
        EXPECT_LE(predicted, work);
      }
    }
  }
  EXPECT_EQ(full[0], full[1]);
  EXPECT_EQ(full[0].front(), 0);
  EXPECT_EQ(full[0].back(), 36);
  EXPECT_TRUE(std::ranges::is_sorted(full[0]));
  EXPECT_GT(full[0][2], full[0][1]);
}

// What the caller decides goes before any policy, and back.
// Where sleepers lose their places to those awake, and who has just come looks dear, all go up and down by
// turns, and wake each other for ever.
TEST(Choose, AHeapUnderAnErrorBudgetFallsAsleep) {
  Manager manager = on_floor(
      {.policy = {.policy = ErrorBudgetPolicy{.budget_work = 1000.0}}, .signatures = coarse_signature});
  view_from(manager, {0, -6, 2});
  const auto box = box_shape({0.25, 0.2, 0.2});
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 300; ++i)
    add(manager, box,
        testing::at({random.uniform(-2, 2), random.uniform(-2, 2), 0.5 + 0.02 * i}, Vec3::Zero(),
                    random.uniform(0, 5) * random.direction()));
  run(manager, 12.0);
  EXPECT_GT(manager.report().asleep, 290);
  int changes = 0;
  for (int i = 0; i < 300; ++i) {
    manager.step(kFrame);
    changes += int(manager.rung_changes().size());
  }
  EXPECT_LT(changes, 10);
}

TEST(Choose, TheCallersChoiceGoesBeforeThePolicy) {
  std::vector<BodyId> bodies;
  Manager manager = grid_in_space(at_once(DistancePolicy{2.5}), 6, bodies);
  view_from(manager, {0, 0, 0});
  manager.step(kFrame);
  const BodyId near = bodies[0], far = bodies[35];
  manager.set_level(near, LevelChoice::support), manager.set_level(far, LevelChoice::full);
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(near), Rung::support);
  EXPECT_EQ(manager.rung(far), Rung::full);
  EXPECT_EQ(manager.explain(far).rule, Rule::forced);
  manager.set_level(near, LevelChoice::automatic), manager.set_level(far, LevelChoice::automatic);
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(near), Rung::full);
  EXPECT_EQ(manager.rung(far), Rung::support);
  manager.set_rung_range(near, Rung::tables, Rung::support);
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(near), Rung::support);
  manager.set_rung_range(near, Rung::support, Rung::support);
  manager.step(kFrame);
  EXPECT_EQ(manager.explain(near).rule, Rule::rung_range);
  manager.set_rung_range(far, Rung::full, Rung::full);
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(far), Rung::full);
  EXPECT_EQ(manager.explain(far).rule, Rule::rung_range);
}

// What will hit a full body within the look-ahead is full before it does, though no viewpoint is near its
// way.
TEST(Choose, LooksAheadToAHit) {
  for (const double ahead : {0.0, 0.5}) {
    PolicySettings policy = at_once(DistancePolicy{2.0});
    policy.look_ahead_s = ahead;
    ManagerSettings settings = unmeasured(policy);
    settings.gravity = Vec3::Zero();
    Manager manager(settings);
    const auto box = box_shape({0.3, 0.3, 0.3});
    const BodyId target = add(manager, box, testing::at({0, 0, 0}));
    manager.set_importance(target, 10.0);
    const BodyId shot = add(manager, box, testing::at({-8, 0, 0}, {10, 0, 0})),
                 miss = add(manager, box, testing::at({-8, -3, 0}, {10, 0, 0}));
    view_from(manager, {0, 8, 0});
    double full_at = 1e9;
    for (int i = 0; i < 40 && full_at == 1e9; ++i) {
      manager.step(kFrame);
      EXPECT_EQ(manager.rung(target), Rung::full);
      if (manager.rung(shot) == Rung::full) full_at = manager.state(shot).position.x();
    }
    EXPECT_NE(manager.rung(miss), Rung::full);
    if (ahead > 0.0) {
      EXPECT_NEAR(full_at, -5.0, 1.0);
    } else {
      EXPECT_EQ(full_at, 1e9);
    }
  }
}

}  // namespace
}  // namespace lodestone
