// Changes of rung as they are made, and promotions that are put off.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

PolicySettings near_is_full() {
  return {.policy = DistancePolicy{5.0}, .min_dwell_frames = 0, .max_transitions_per_frame = 100};
}

// A body in a full one: its promotion is tried again after 8, 16, 32 … steps, 128 at most, and made once
// there is room.
TEST(MoveBodies, APromotionIsTriedAgainMoreAndMoreSeldom) {
  ManagerSettings settings = unmeasured(near_is_full());
  settings.gravity = Vec3::Zero();
  Manager manager(settings);
  const auto box = box_shape({0.4, 0.4, 0.4});
  view_from(manager, {100, 0, 0});
  BodyProperties fixed;
  fixed.kinematic = true;
  const BodyId inner = manager.add_body({.shape = box, .state = testing::at({0, 0, 0}), .properties = fixed});
  const BodyId outer = manager.add_body(
      {.shape = box, .state = testing::at({0.1, 0, 0}), .level = LevelChoice::full, .properties = fixed});
  manager.step(kFrame);
  view_from(manager, {0, 0, 0});
  std::vector<int> tried;
  std::int64_t before = manager.report().counters.promotions_put_off;
  for (int step = 0; step < 520; ++step) {
    manager.step(kFrame);
    if (manager.report().counters.promotions_put_off > before) tried.push_back(step);
    before = manager.report().counters.promotions_put_off;
    EXPECT_EQ(manager.rung(inner), Rung::support);
  }
  ASSERT_GE(tried.size(), 6U);
  for (std::size_t i = 1; i < tried.size(); ++i)
    EXPECT_NEAR(tried[i] - tried[i - 1], std::min(128, 4 << i), 1) << i;
  EXPECT_EQ(manager.explain(inner).rule, Rule::overlap_put_off);
  manager.remove_body(outer);
  for (int step = 0; step < 130 && manager.rung(inner) != Rung::full; ++step) manager.step(kFrame);
  EXPECT_EQ(manager.rung(inner), Rung::full);
}

// What the step says it changed is what it changed.
TEST(MoveBodies, ChangesAreListedAsTheyAreMade) {
  Manager manager = on_floor(unmeasured(near_is_full()));
  std::vector<BodyId> bodies;
  std::vector<Rung> rungs;
  for (int i = 0; i < 12; ++i)
    bodies.push_back(add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({2.0 * i, 0, 0.1})));
  view_from(manager, {-50, 0, 0});
  manager.step(kFrame);
  for (const BodyId body : bodies) rungs.push_back(manager.rung(body));
  int changes = 0;
  for (int step = 0; step < 60; ++step) {
    view_from(manager, {-10.0 + 0.7 * step, 0, 0});
    manager.step(kFrame);
    int up = 0, down = 0;
    for (const RungChange& change : manager.rung_changes()) {
      const auto which = std::size_t(std::ranges::find(bodies, change.body) - bodies.begin());
      EXPECT_EQ(change.from, rungs[which]);
      rungs[which] = change.to;
      (change.to > change.from ? up : down) += 1;
      ++changes;
    }
    EXPECT_EQ(up, manager.report().promotions);
    EXPECT_EQ(down, manager.report().demotions);
    for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_EQ(manager.rung(bodies[i]), rungs[i]);
  }
  EXPECT_GT(changes, 20);
}

// Where it is, how fast it goes and turns: a change of rung in flight alters none of it.
TEST(MoveBodies, AFlightGoesOnOverChanges) {
  ManagerSettings settings = unmeasured(near_is_full());
  settings.gravity = Vec3::Zero();
  Manager manager(settings);
  const BodyId body = add(manager, sphere_shape(0.2), testing::at({0, 0, 0}, {1, 2, 3}, {3, 2, 1}));
  for (int step = 0; step < 40; ++step) {
    view_from(manager, step % 8 < 4 ? Vec3(manager.state(body).position) : Vec3(1e3, 0, 0));
    manager.step(kFrame);
  }
  EXPECT_LT((manager.state(body).position - 40 * kFrame * Vec3(1, 2, 3)).norm(), 1e-9);
  EXPECT_LT((manager.state(body).velocity - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((manager.state(body).angular_velocity - Vec3(3, 2, 1)).norm(), 1e-6);
  EXPECT_GT(manager.report().counters.ode_bodies_created, 3);
}

}  // namespace
}  // namespace lodestone
