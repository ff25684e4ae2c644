#include "lod/manager/audit.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// Against two passes over all values.
TEST(RunningMean, IsThatOfAllValues) {
  RandomStream random(67, 0, 0);
  for (const double offset : {0.0, 1e6}) {
    RunningMean running;
    EXPECT_EQ(running.mean(), 0.0);
    EXPECT_EQ(running.deviation(), 0.0);
    std::vector<double> values;
    for (int i = 0; i < 500; ++i) {
      values.push_back(offset + 3.0 * random.normal());
      running.add(values.back());
    }
    double mean = 0.0, squares = 0.0;
    for (const double value : values) mean += value / 500;
    for (const double value : values) squares += (value - mean) * (value - mean);
    EXPECT_EQ(running.count(), 500);
    EXPECT_NEAR(running.mean(), mean, 1e-9 * (1 + offset));
    EXPECT_NEAR(running.deviation(), std::sqrt(squares / 499), 1e-9);
    EXPECT_NEAR(running.standard_error(), std::sqrt(squares / 499 / 500), 1e-9);
  }
}

TEST(RunningMean, OfOneHasNoSpread) {
  RunningMean running;
  running.add(7.0);
  EXPECT_EQ(running.mean(), 7.0);
  EXPECT_EQ(running.deviation(), 0.0);
  EXPECT_EQ(running.standard_error(), 0.0);
}

TEST(WayToRest, EndsOnceItHasBeenStillForASecond) {
  WayToRest way(at({1, 2, 3}), 0.5);
  double t = 0.0;
  const auto sample = [&](const Vec3& place, double energy, bool asleep = false) {
    way.sample(t += 0.1, at(place), energy, asleep);
  };
  for (int i = 0; i < 8; ++i) sample({1, 2, 3.0 - 0.1 * i}, 1.0);
  sample({2, 2, 2}, 1.0);  // .9 s
  for (int i = 0; i < 9; ++i) sample({4, 6, 1.5}, 1e-3);
  EXPECT_FALSE(way.done());
  sample({4, 6, 1.5}, 1e-3);  // 1.9 s
  EXPECT_TRUE(way.done());
  EXPECT_NEAR(way.rest_time_s(), 0.9, 1e-12);
  EXPECT_NEAR(way.distance_m(Vec3::UnitZ()), 5.0, 1e-12);
  EXPECT_NEAR(way.rest_height(Vec3::UnitZ()), 1.5 / 0.5, 1e-12);
  EXPECT_LT((way.a_second_on() - Vec3(4, 6, 1.5)).norm(), 1e-12);  // at 1.0 s
  sample({9, 9, 9}, 5.0);
  EXPECT_NEAR(way.distance_m(Vec3::UnitZ()), 5.0, 1e-12);  // it is over
}

TEST(WayToRest, SleepAndTheHorizonEndItToo) {
  WayToRest asleep(at({0, 0, 0}), 1.0), moving(at({0, 0, 0}), 1.0);
  asleep.sample(0.1, at({0, 0, 0}), 1.0, true);
  EXPECT_TRUE(asleep.done());
  int samples = 0;
  while (!moving.done() && samples < 2000) moving.sample(++samples / 60.0, at({0, 0, 0}), 1.0, false);
  EXPECT_EQ(samples, 600);  // ten seconds
}

// Ten balls go down from the full level in mid-fall; the audit simulates each on in full, changes nothing of
// the world, and finds that balls on a plane do much the same on both.
TEST(Audit, ComparesBodiesWithoutTouchingTheWorld) {
  std::uint64_t hashes[2];
  for (const bool audited : {false, true}) {
    ManagerSettings settings = unmeasured();
    settings.audit_ms = audited ? 20.0 : 0.0;
    Manager manager = on_floor(settings);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 10; ++i)
      bodies.push_back(add(manager, box_shape({0.2, 0.25, 0.3}),
                           at({2.0 * i, 0, 0.4 + 0.02 * i}, {0.3, 0.1 * i, 0}, {1, 0.3 * i, 0}),
                           LevelChoice::full));
    for (int i = 0; i < 5; ++i) manager.step(kFrame);
    for (const BodyId body : bodies) manager.set_level(body, LevelChoice::support);
    manager.step(kFrame);
    if (audited) {
      EXPECT_GT(manager.report().audit.watched, 0);
    }
    for (int i = 0; i < 180; ++i) manager.step(kFrame);
    hashes[audited] = manager.state_hash();
    if (!audited) {
      EXPECT_EQ(manager.report().audit.bodies, 0);
      continue;
    }
    const AuditReport& audit = manager.report().audit;
    EXPECT_EQ(audit.bodies + audit.watched + audit.left_out, 10);
    EXPECT_GT(audit.bodies, 4);
    EXPECT_GT(audit.rest_time_s.full, 0.0);
    EXPECT_LT(audit.rest_time_s.difference[0], audit.rest_time_s.difference[1]);
    EXPECT_LT(std::abs(audit.rest_height.full - audit.rest_height.demoted), 0.3);
    EXPECT_GE(audit.drift, 0.0);
    EXPECT_LE(audit.drift_interval[0], audit.drift);
    EXPECT_GE(audit.drift_interval[1], audit.drift);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Audit, LeavesOutWhatTheCallerMoves) {
  ManagerSettings settings = unmeasured();
  settings.audit_ms = 20.0;
  Manager manager = on_floor(settings);
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 3}), LevelChoice::full);
  manager.step(kFrame);
  manager.set_level(body, LevelChoice::support);
  manager.step(kFrame);
  ASSERT_EQ(manager.report().audit.watched, 1);
  manager.add_impulse(body, {5, 0, 0}, manager.state(body).position);
  for (int i = 0; i < 3; ++i) manager.step(kFrame);
  EXPECT_EQ(manager.report().audit.left_out, 1);
  EXPECT_EQ(manager.report().audit.watched, 0);
}

// What goes down, comes up before its audit is done, and goes down once more is compared with a simulation
// from where it went down last.
TEST(Audit, EachGoingDownIsSimulatedFromItsOwnStart) {
  ManagerSettings settings = unmeasured();
  settings.audit_ms = 0.05;  // some steps of the simulation in each
  Manager manager = on_floor(settings);
  const BodyId body = add(manager, box_shape({0.2, 0.3, 0.4}), at({0, 0, 12}, {3, 0, 0}), LevelChoice::full);
  run(manager, 0.1);
  manager.set_level(body, LevelChoice::support);
  run(manager, 0.2);
  manager.set_level(body, LevelChoice::full);
  run(manager, 0.4);
  ASSERT_EQ(manager.report().audit.left_out, 1);
  manager.set_level(body, LevelChoice::support);
  for (int i = 0; i < 3000 && manager.report().audit.bodies == 0; ++i) manager.step(kFrame);
  ASSERT_EQ(manager.report().audit.bodies, 1);
  EXPECT_LT(manager.report().audit.drift, 0.5);  // a second on, in flight; sizes
}

}  // namespace
}  // namespace lodestone
