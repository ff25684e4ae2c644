// Bodies that were added at one place come in a few at a time, on every rung.
#include "lod/manager/crowded_places.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

std::vector<BodyId> add_at_one_place(Manager& manager, int count, LevelChoice level,
                                     const BodyProperties& properties = {}) {
  std::vector<BodyId> bodies;
  for (int i = 0; i < count; ++i)
    bodies.push_back(manager.add_body({.shape = box_shape({0.2, 0.3, 0.4}),
                                       .state = testing::at({0.1, 0.1, 1.0}),
                                       .level = level,
                                       .properties = properties}));
  return bodies;
}

int placed(const Manager& manager, std::span<const BodyId> bodies) {
  int count = 0;
  for (const BodyId body : bodies) count += manager.explain(body).placed;
  return count;
}

TEST(CrowdedPlaces, FewTakePartAtATimeAndAllInTheEnd) {
  static const auto signature = coarse_signature(*box_shape({0.2, 0.3, 0.4}), {});
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables, LevelChoice::full}) {
    ManagerSettings settings = unmeasured();
    settings.signatures = [](const Shape&, const ContactLaw&) { return signature; };
    Manager manager = on_floor(settings);
    const std::vector<BodyId> bodies = add_at_one_place(manager, 24, level);
    manager.step(kFrame);
    EXPECT_EQ(placed(manager, bodies), kBodiesOfAPlace) << int(level);
    EXPECT_EQ(manager.report().counters.bodies_held_back, 24 - kBodiesOfAPlace);
    for (int i = 0; i < 300; ++i) {
      const StepReport& report = manager.step(kFrame);
      ASSERT_EQ(report.full + report.statistical, 24) << i;
      ASSERT_EQ(report.support + report.tables, report.statistical) << i;
    }
    EXPECT_EQ(placed(manager, bodies), 24) << int(level);
    const std::int64_t held = manager.report().counters.bodies_held_back;
    manager.step(kFrame);
    EXPECT_EQ(manager.report().counters.bodies_held_back, held);
    for (const BodyId body : bodies) EXPECT_GT(manager.state(body).position.z(), 0.0) << int(level);
  }
}

// Debris hung in the air, though its pieces do not meet.
TEST(CrowdedPlaces, WhomTheFilterLetsThroughEachOtherComeAtOnce) {
  ManagerSettings settings = unmeasured();
  settings.pair_filter = [](BodyId, BodyId) { return false; };
  Manager manager = on_floor(settings);
  const std::vector<BodyId> bodies = add_at_one_place(manager, 60, LevelChoice::support);
  manager.step(kFrame);
  EXPECT_EQ(placed(manager, bodies), 60);
}

// Nor does it matter to the others that the first meets none of them.
TEST(CrowdedPlaces, OneThatMeetsNobodyLeavesTheOthersACrowd) {
  ManagerSettings settings = unmeasured();
  settings.pair_filter = [](BodyId a, BodyId b) { return a.index != 0 && b.index != 0; };
  Manager manager = on_floor(settings);
  const std::vector<BodyId> bodies = add_at_one_place(manager, 60, LevelChoice::support);
  manager.step(kFrame);
  EXPECT_EQ(placed(manager, bodies), 1 + kBodiesOfAPlace);
}

// Whoever was let in is pushed aside by less than its size a step: nobody comes before there is room.
TEST(CrowdedPlaces, ThereIsRoomForThoseThatAreLetIn) {
  Manager manager = on_floor();
  const std::vector<BodyId> bodies = add_at_one_place(manager, 600, LevelChoice::support);
  const Vec3 place(0.1, 0.1, 1.0);
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    int near = 0;
    for (const BodyId body : bodies)
      near += manager.explain(body).placed &&
              (manager.state(body).position - place).norm() < manager.shape(body).radius;
    ASSERT_LE(near, 2 * kBodiesOfAPlace + i / 8) << i;
  }
}

// 72 times as many as fit into a cubic metre, no two of them at one place.
TEST(CrowdedPlaces, NoMoreThanFitTakePartWhereManyAreGivenDensely) {
  Manager manager = on_floor();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 3000; ++i)
    bodies.push_back(add(manager, box_shape({0.2, 0.3, 0.4}),
                         testing::at({i % 15 / 15.0, i / 15 % 14 / 14.0, 1.0 + i / 210 / 15.0}),
                         LevelChoice::support));
  manager.step(kFrame);
  const int at_first = placed(manager, bodies);
  EXPECT_LT(at_first, 200);
  EXPECT_GT(at_first, 20);
  for (int i = 0; i < 8; ++i) manager.step(kFrame);
  EXPECT_GT(placed(manager, bodies), at_first);
  EXPECT_LT(placed(manager, bodies), 400);
}

// Five times as many as fit; each wave of them is a system for ODE whose time grows faster than it does.
TEST(CrowdedPlaces, FullOnesOverlappingInARoomComeAsTheyFit) {
  Manager manager = on_floor();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 200; ++i)
    bodies.push_back(add(manager, box_shape({0.2, 0.3, 0.4}),
                         testing::at({i % 7 / 7.0, i / 7 % 7 / 7.0, 1.0 + i / 49 / 7.0}), LevelChoice::full));
  EXPECT_GT(placed(manager, bodies), 20);
  int most = placed(manager, bodies), before = most;
  EXPECT_LT(most, 60);
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    const int now = placed(manager, bodies);
    most = std::max(most, now - before), before = now;
  }
  EXPECT_LT(most, 60);
  EXPECT_EQ(before, 200);
}

// Cubes that touch, eight with their centres in a room: none waits.
TEST(CrowdedPlaces, FullOnesThatTouchAreThereAtOnce) {
  Manager manager = on_floor();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 64; ++i)
    bodies.push_back(add(manager, box_shape({0.25, 0.25, 0.25}),
                         testing::at({0.25 * (i % 4), 0.25 * (i / 4 % 4), 0.5 + 0.25 * (i / 16)}),
                         LevelChoice::full));
  EXPECT_EQ(placed(manager, bodies), 64);
}

// That meet none of their kind, that are apart, if only by the thickness of a plate, and that come one after
// the other.
TEST(CrowdedPlaces, OthersDoNotWait) {
  Manager manager = on_floor();
  std::vector<BodyId> bodies =
      add_at_one_place(manager, 12, LevelChoice::support, {.collide = 0u, .kinematic = true});
  for (int i = 0; i < 200; ++i)
    bodies.push_back(add(manager, box_shape({0.2, 0.3, 0.4}),
                         testing::at({0.5 * (i % 20), 2.0 + 0.5 * (i / 20), 1.0}), LevelChoice::support));
  for (int i = 0; i < 20; ++i)
    bodies.push_back(add(manager, box_shape({0.2, 0.2, 0.004}), testing::at({-2, 0, 0.002 + 0.0041 * i}),
                         i % 2 ? LevelChoice::support : LevelChoice::full));
  manager.step(kFrame);
  EXPECT_EQ(placed(manager, bodies), int(bodies.size()));
  for (int i = 0; i < 6; ++i) {
    const BodyId late =
        add(manager, box_shape({0.2, 0.3, 0.4}), testing::at({-5, 0, 1}), LevelChoice::support);
    manager.step(kFrame);
    EXPECT_TRUE(manager.explain(late).placed);
  }
  EXPECT_EQ(manager.report().counters.bodies_held_back, 0);
}

TEST(CrowdedPlaces, WaitingBodiesArePartOfASnapshotAndMayBeRemoved) {
  Manager manager = on_floor(), other = on_floor();
  const std::vector<BodyId> bodies = add_at_one_place(manager, 12, LevelChoice::support);
  manager.step(kFrame);
  manager.remove_body(bodies[11]);
  const std::shared_ptr<const Shape> shapes[] = {box_shape({0.2, 0.3, 0.4})};
  other.restore(manager.snapshot(), shapes);
  for (Manager* each : {&manager, &other}) run(*each, 1.0);
  EXPECT_EQ(manager.state_hash(), other.state_hash());
  EXPECT_EQ(placed(manager, std::span(bodies).first(11)), 11);
}

}  // namespace
}  // namespace lodestone
