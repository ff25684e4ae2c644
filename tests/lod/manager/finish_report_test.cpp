// The numbers of a step, against a look at each body.
#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct Counted {
  int full = 0, support = 0, tables = 0, asleep = 0;
  Counted(const Manager& manager, std::span<const BodyId> bodies) {
    for (const BodyId body : bodies) {
      const Rung rung = manager.rung(body);
      ++(rung == Rung::full ? full : rung == Rung::support ? support : tables);
      asleep += manager.asleep(body);
    }
  }
};

TEST(FinishReport, CountsBodiesByRungAndSleep) {
  Manager manager = on_floor(
      unmeasured({.policy = DistancePolicy{2.0}, .min_dwell_frames = 0, .max_transitions_per_frame = 3}));
  RandomStream random(17, 0, 0);
  std::vector<BodyId> bodies;
  int slept = 0;
  for (int step = 0; step < 150; ++step) {
    if (step % 6 == 0 && bodies.size() < 14)
      bodies.push_back(add(manager, box_shape({0.2, 0.2, 0.2}),
                           testing::at({random.uniform(-4, 4), random.uniform(-4, 4), 0.3})));
    if (step % 20 == 19) {
      manager.remove_body(bodies.front());
      bodies.erase(bodies.begin());
    }
    view_from(manager, {4.0 * std::sin(0.05 * step), 0, 0.5});
    const StepReport& report = manager.step(kFrame);
    const Counted counted(manager, bodies);
    EXPECT_EQ(report.full, counted.full);
    EXPECT_EQ(report.support, counted.support);
    EXPECT_EQ(report.tables, counted.tables);
    EXPECT_EQ(report.statistical, counted.support + counted.tables);
    EXPECT_EQ(report.asleep, counted.asleep);
    EXPECT_EQ(report.step, step + 1);
    EXPECT_EQ(report.dt_s, kFrame);
    slept = std::max(slept, counted.asleep);
  }
  EXPECT_GT(slept, 3);
}

// A pause reports a step of nothing; a hitch counts as its parts.
TEST(FinishReport, PausesAndHitches) {
  Manager manager = on_floor();
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 5}));
  manager.step(kFrame);
  const Vec3 place = manager.state(body).position;
  const StepReport& paused = manager.step(0.0);
  EXPECT_EQ(paused.dt_s, 0.0);
  EXPECT_EQ(paused.step, 1);
  EXPECT_EQ(manager.state(body).position, place);
  EXPECT_TRUE(manager.moved().empty());
  const StepReport& hitch = manager.step(0.35);
  EXPECT_EQ(hitch.counters.divided_steps, 1);
  EXPECT_EQ(hitch.step, 1 + 4);
  EXPECT_NEAR(hitch.dt_s, 0.35, 1e-12);
}

// Under a budget each rung's cost is told, and what the whole was predicted to cost is no less than those.
TEST(FinishReport, CostsAreToldUnderABudgetOnly) {
  for (const bool budget : {false, true}) {
    Manager manager =
        on_floor(unmeasured(budget ? PolicySettings{.policy = WorkPolicy{3000.0}} : PolicySettings{}));
    for (int i = 0; i < 8; ++i) add(manager, box_shape({0.2, 0.2, 0.2}), testing::at({1.0 * i, 0, 2}));
    view_from(manager, {0, 0, 1});
    for (int i = 0; i < 5; ++i) manager.step(kFrame);
    double work = 0.0;
    for (const RungCost& cost : manager.report().cost) work += cost.work;
    EXPECT_EQ(work > 0.0, budget);
  }
}

}  // namespace
}  // namespace lodestone
