// The lists of a step, against a look at every body before and after it; and queries against a look at every
// body, while all of them come, go, move and change rung.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "lod/queries/triangle_tree.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::step_changes_test {
namespace {

using namespace testing;

using Ids = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Ids ids_of(std::span<const BodyId> bodies) {
  Ids ids;
  for (const BodyId body : bodies)
    EXPECT_TRUE(ids.emplace(body.index, body.generation).second) << "twice in the list";
  return ids;
}

struct Known {
  BodyId id;
  bool asleep = false;
  Rung rung = Rung::support;
  RigidState state;
};

// A pile of balls and boxes; a camera that comes and goes; bodies pushed, laid to sleep, woken, moved,
// removed and added by the caller.
class LivelyScene : public ::testing::Test {
 protected:
  LivelyScene()
      : manager(on_floor(unmeasured({.policy = DistancePolicy{.full_within = 2.0},
                                     .min_dwell_frames = 5,
                                     .max_transitions_per_frame = 20}))) {
    for (int i = 0; i < 60; ++i) add_one();
  }
  void add_one() {
    const RigidState state = at({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0.3, 3)});
    bodies.push_back(add(manager, random.uniform() < 0.5 ? ball : box, state));
    fresh.emplace(bodies.back().index, bodies.back().generation);
  }
  BodyId any() { return bodies[std::size_t(random.uniform() * double(bodies.size()))]; }
  void meddle() {
    const double what = random.uniform();
    if (what < 0.05)
      manager.sleep(any());
    else if (what < 0.1)
      manager.wake(any());
    else if (what < 0.15)
      manager.add_impulse(any(), {0, 0, 20}, {0, 0, 0});
    else if (what < 0.2)
      manager.set_state(any(), at({random.uniform(-2, 2), random.uniform(-2, 2), 3}));
    else if (what < 0.22)
      add_one();
    else if (what < 0.24)
      remove_one();
    else if (what < 0.26)
      manager.set_level(any(), random.uniform() < 0.5 ? LevelChoice::full : LevelChoice::automatic);
    view_from(manager, {3.0 * std::sin(0.02 * double(manager.report().step)), 0, 1});
  }
  void remove_one() {
    const std::size_t gone = std::size_t(random.uniform() * double(bodies.size()));
    manager.remove_body(bodies[gone]);
    bodies.erase(bodies.begin() + std::ptrdiff_t(gone));
  }
  std::vector<Known> look() const {
    std::vector<Known> all;
    for (const BodyId body : bodies)
      all.push_back({body, manager.asleep(body), manager.rung(body), manager.state(body)});
    return all;
  }

  RandomStream random{3, 0, 0};
  std::shared_ptr<const Shape> ball = sphere_shape(0.15), box = box_shape({0.2, 0.25, 0.3});
  Manager manager;
  std::vector<BodyId> bodies;
  Ids fresh;  // on no rung before the next step
};

TEST_F(LivelyScene, ListsSayWhatChanged) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> slept;  // after the step before
  std::size_t fell = 0, woke = 0, changed = 0;
  for (int i = 0; i < 900; ++i) {
    meddle();
    const std::vector<Known> before = look();
    manager.step(kFrame);
    const std::vector<Known> after = look();
    Ids fell_asleep, woken, moved;
    std::size_t changes = 0;
    for (std::size_t b = 0; b < before.size(); ++b) {
      const auto id = std::pair(before[b].id.index, before[b].id.generation);
      const bool was_asleep = slept.contains(id) && slept[id];
      if (after[b].asleep && !was_asleep) fell_asleep.insert(id);
      if (!after[b].asleep && was_asleep) woken.insert(id);
      if (before[b].state.position != after[b].state.position) moved.insert(id);
      changes += before[b].rung != after[b].rung && !fresh.contains(id);
      slept[id] = after[b].asleep;
    }
    fresh.clear();
    EXPECT_EQ(ids_of(manager.fell_asleep()), fell_asleep) << i;
    EXPECT_EQ(ids_of(manager.woke()), woken) << i;
    EXPECT_EQ(manager.rung_changes().size(), changes) << i;
    const Ids listed = ids_of(manager.moved());
    for (const auto& id : moved) EXPECT_TRUE(listed.contains(id)) << i;
    fell += fell_asleep.size(), woke += woken.size(), changed += changes;
  }
  EXPECT_GT(fell, 50u);
  EXPECT_GT(woke, 20u);
  EXPECT_GT(changed, 20u);
}

TEST_F(LivelyScene, MovedIsNobodyWhereAllSleep) {
  run(manager, 5.0);
  for (const BodyId body : bodies) manager.sleep(body);
  manager.step(kFrame);
  EXPECT_EQ(manager.report().asleep, int(bodies.size()));
  manager.step(kFrame);
  EXPECT_TRUE(manager.moved().empty());
}

// Balls alone are asked about, whose distance is known in closed form; every few steps, so that the queries
// have to catch up.
TEST_F(LivelyScene, RaysMeetTheBodiesWhereTheyAreNow) {
  int met = 0;
  for (int i = 0; i < 600; ++i) {
    meddle();
    if (i % 4 != 3) manager.step(kFrame);
    if (i % 7 > 1) continue;
    for (int k = 0; k < 5; ++k) {
      const Vec3 from = 4.0 * random.direction(),
                 direction =
                     (Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 0.5)) - from)
                         .normalized();
      double nearest = 20.0;
      BodyId expected;
      for (const BodyId body : bodies) {
        const RigidState state = manager.state(body);
        const auto hit = &manager.shape(body) == ball.get()
                             ? meet_sphere(from, direction, nearest, state.position, 0.15)
                             : std::optional<double>();
        if (hit && *hit > 0.0) nearest = *hit, expected = body;
      }
      std::vector<QueryHit> hits[1];
      const Ray ray{from, direction, 20.0};
      manager.cast_rays_through({&ray, 1}, hits, {.ground = false});
      std::erase_if(hits[0], [&](const QueryHit& hit) { return &manager.shape(hit.who.body) != ball.get(); });
      ASSERT_EQ(!hits[0].empty(), bool(expected));
      if (!expected) continue;
      EXPECT_EQ(hits[0][0].who.body, expected);
      EXPECT_NEAR(hits[0][0].distance, nearest, 1e-9);
      ++met;
    }
  }
  EXPECT_GT(met, 100);
}

// A body of `tables` with properties of its own goes to `support` at once.
TEST(StepChanges, WhatChangesRungBetweenStepsIsToldAfterTheNext) {
  ManagerSettings settings = unmeasured();
  settings.signatures = coarse_signature;
  Manager manager = on_floor(settings);
  const auto box = box_shape({0.2, 0.3, 0.4});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 3; ++i)
    bodies.push_back(add(manager, box, at({2.0 * i, 0, 1}), LevelChoice::statistical));
  manager.set_policy({.policy = DistancePolicy{.full_within = 0.0, .support_within = 0.0}});
  view_from(manager, {100, 0, 0});
  manager.step(kFrame);
  ASSERT_EQ(manager.report().tables, 3);
  const auto told = manager.rung_changes();
  const std::vector<RungChange> before(told.begin(), told.end());
  for (const BodyId body : bodies) manager.set_properties(body, {.linear_damping = 0.1});
  EXPECT_TRUE(std::ranges::equal(manager.rung_changes(), before));
  manager.step(kFrame);
  ASSERT_EQ(manager.rung_changes().size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(manager.rung_changes()[i], (RungChange{bodies[i], Rung::tables, Rung::support}));
}

// Whatever the caller does to bodies before he asks.
TEST(StepChanges, WhoMovedIsOfTheStepNotOfTheQuestion) {
  Manager manager = on_floor();
  const auto box = box_shape({0.3, 0.3, 0.3});
  const BodyId removed = add(manager, box, at({0, 0, 1})), laid = add(manager, box, at({2, 0, 1})),
               still = add(manager, box, at({4, 0, 0.15}));
  manager.sleep(still);
  manager.step(kFrame);
  manager.step(kFrame);
  const Ids expected{{removed.index, removed.generation}, {laid.index, laid.generation}};
  manager.remove_body(removed);
  manager.sleep(laid);
  manager.wake(still);
  add(manager, box, at({6, 0, 1}), LevelChoice::full);
  EXPECT_EQ(ids_of(manager.moved()), expected);
}

TEST(StepChanges, TheLastStatisticalBodyFallsAsleepOnce) {
  Manager manager = on_floor();
  const BodyId box = add(manager, box_shape({0.3, 0.3, 0.3}), at({0, 0, 0.2}), LevelChoice::support);
  while (manager.fell_asleep().empty()) manager.step(kFrame);
  manager.set_level(box, LevelChoice::full);
  manager.step(kFrame);
  for (int i = 0; i < 3; ++i) {
    manager.step(kFrame);
    EXPECT_TRUE(manager.moved().empty());
  }
}

// It lay elsewhere when it was full before.
TEST(StepChanges, WhoIsPromotedAsleepDidNotMove) {
  Manager manager =
      on_floor(unmeasured({.policy = DistancePolicy{.full_within = 3.0}, .min_dwell_frames = 0}));
  const BodyId box = add(manager, box_shape({0.2, 0.3, 0.4}), at({1, 0, 0.21}));
  for (int i = 0; i < 3; ++i) {
    view_from(manager, {100, 0, 0});
    manager.set_state(box, at({1.0 + 0.3 * i, 0, 0.21}));
    run(manager, 3.0);
    ASSERT_TRUE(manager.asleep(box));
    ASSERT_NE(manager.rung(box), Rung::full);
    view_from(manager, {0, 0, 1});
    manager.step(kFrame);
    ASSERT_TRUE(manager.asleep(box));
    ASSERT_EQ(manager.rung(box), Rung::full);
    EXPECT_TRUE(manager.moved().empty());
  }
}

}  // namespace
}  // namespace lodestone::step_changes_test
