// Heaps of `tables`: what is poured lies beside and on each other, not in each other.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tools/compare/pile_overlap.h"
#include "tools/compare/pile_start.h"

namespace lodestone {
namespace {

using namespace testing;

// Of 100 bodies that fall from up to 8 m into a bin, after six seconds, over their size.
double deepest_overlap_of_poured(const std::shared_ptr<const Shape>& shape, double side, std::uint64_t seed) {
  const auto signature = coarse_signature(*shape, {.restitution = 0.4, .friction = 0.5});
  Manager manager({.signatures = [&](const Shape&, const ContactLaw&) { return signature; }});
  const std::vector<HalfSpace> bin = make_bin(side);
  for (const HalfSpace& plane : bin) manager.add_plane(plane.normal, plane.offset);
  std::vector<BodyId> bodies;
  for (const RigidState& state : make_pile_start(*shape, {.bodies = 100, .side = side}, seed))
    bodies.push_back(add(manager, shape, state, LevelChoice::tables));
  for (int step = 0; step < 360; ++step) manager.step(kFrame);
  std::vector<RigidState> states;
  for (const BodyId body : bodies) states.push_back(manager.state(body));
  return PileOverlap(*shape, bin).deepest(states) / shape->size;
}

TEST(TablesHeap, PouredBoxesLieBesideEachOther) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  // Of sixty such piles the mean is .081, and in three of them, somewhere, two are deeper than a fifth.
  double sum = 0.0;
  int deep = 0;
  constexpr int kPiles = 24;
  for (std::uint64_t seed = 1; seed <= kPiles; ++seed) {
    const double deepest = deepest_overlap_of_poured(box, 1.6, seed);
    deep += deepest > 0.2;
    sum += deepest;
  }
  EXPECT_LE(deep, 2);
  EXPECT_LT(sum / kPiles, 0.1);
}

// One that hung by friction among its neighbours, or slipped to and fro, never slept: in one pile of six.
TEST(TablesHeap, WhatIsPouredSleeps) {
  const auto box = box_shape({0.1, 0.3, 0.2});
  const auto signature = coarse_signature(*box, {});
  constexpr double kBin = 1.5;  // m
  for (const std::uint64_t seed : {15u, 28u, 30u, 42u}) {
    Manager manager({.signatures = [&](const Shape&, const ContactLaw&) { return signature; }});
    for (const HalfSpace& plane : make_bin(kBin)) manager.add_plane(plane.normal, plane.offset);
    RandomStream random(7, seed, 0);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 100; ++i) {
      const double within = 0.5 * kBin - 0.2;
      const Vec3 place(random.uniform(-within, within), random.uniform(-within, within), 0.3 + 0.2 * i);
      bodies.push_back(
          add(manager, box, {.position = place, .orientation = random.orientation()}, LevelChoice::tables));
    }
    run(manager, 10.0);
    for (const BodyId body : bodies) EXPECT_TRUE(manager.asleep(body)) << seed << ": " << body.index;
  }
}

// Of few sleepers each looks for who is awake, among many each of those awake looks for sleepers: they find
// the same. Boxes fall onto a heap that sleeps, once with many asleep far away.
TEST(TablesHeap, SleepersFarAwayChangeNothing) {
  constexpr int kHeap = 60, kFalling = 20, kFar = 1'500;
  const auto box = box_shape({0.2, 0.3, 0.4});
  const auto signature = coarse_signature(*box, {});
  const auto states_after = [&](int far) {
    Manager manager({.signatures = [&](const Shape&, const ContactLaw&) { return signature; }});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    for (const double side : {-1.1, 1.1}) {
      manager.add_static_box({1, 4, 8}, {side, 0, 4}, Quat::Identity());
      manager.add_static_box({4, 1, 8}, {0, side, 4}, Quat::Identity());
    }
    RandomStream random(10, 0, 0);
    std::vector<BodyId> bodies;
    for (int i = 0; i < kHeap + kFalling; ++i)
      bodies.push_back(add(manager, box,
                           {.position = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.3 + 0.3 * i},
                            .orientation = random.orientation()},
                           LevelChoice::tables));
    run(manager, 15.0);
    for (int i = 0; i < far; ++i)
      bodies.push_back(
          add(manager, box, testing::at({0.8 * (i % 40) + 50.0, 0.8 * (i / 40), 0.2}), LevelChoice::tables));
    run(manager, 5.0);
    for (const BodyId body : bodies) EXPECT_TRUE(manager.asleep(body)) << body.index;
    for (int i = kHeap; i < kHeap + kFalling; ++i)
      manager.set_state(bodies[std::size_t(i)], {.position = {0.0, 0.0, 2.5 + 0.5 * (i - kHeap)},
                                                 .orientation = random.orientation()});
    std::vector<RigidState> states;
    for (int step = 0; step < 240; ++step) {
      manager.step(kFrame);
      for (int i = 0; i < kHeap + kFalling; ++i) states.push_back(manager.state(bodies[std::size_t(i)]));
    }
    return states;
  };
  const auto few = states_after(0), many = states_after(kFar);
  ASSERT_EQ(few.size(), many.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    ASSERT_EQ(few[i].position, many[i].position) << i;
    ASSERT_EQ(few[i].velocity, many[i].velocity) << i;
  }
}

// One that leaned over another's end met it once it was deep in it, was lifted out and fell again, for ever:
// in one pour of ten.
TEST(TablesHeap, PostsThatLeanOverEachOtherSleep) {
  const auto post = box_shape({0.1, 0.1, 0.5});
  const auto signature = coarse_signature(*post, {});
  for (const std::uint64_t seed : {12u, 26u, 33u, 34u, 39u, 52u}) {
    Manager manager({.signatures = [&](const Shape&, const ContactLaw&) { return signature; }});
    for (const HalfSpace& plane : make_bin(1.6)) manager.add_plane(plane.normal, plane.offset);
    RandomStream random(9, seed, 0);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 40; ++i)
      bodies.push_back(add(manager, post,
                           {.position = {0.6 * (i % 3 - 1), 0.6 * (i / 3 % 3 - 1), 0.6 + 0.7 * (i / 9)},
                            .orientation = random.orientation()},
                           LevelChoice::tables));
    run(manager, 12.0);
    for (const BodyId body : bodies) EXPECT_TRUE(manager.asleep(body)) << seed << ": " << body.index;
  }
}

// What the ground gives against a blow is no load: begun with again in the next step it threw balls into the
// air, with up to 3 kJ out of nothing.
TEST(TablesHeap, LivelyBallsGainNothing) {
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.15));
  for (const unsigned seed : {251u, 302u, 339u}) {
    Manager manager({.signatures = coarse_signature});
    manager.materials().replace(0, {.restitution = 0.8, .friction = 0.5});
    for (const HalfSpace& plane : make_bin(2.0)) manager.add_plane(plane.normal, plane.offset);
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> aside(-0.8, 0.8);  // m
    std::vector<BodyId> balls;
    for (int i = 0; i < 150; ++i) {
      const double x = aside(engine), y = aside(engine);
      balls.push_back(
          add(manager, ball, testing::at(Vec3(x, y, 0.5 + 0.06 * i), {0, 0, -5}), LevelChoice::tables));
    }
    const auto energy_of_all = [&] {
      double sum = 0.0;
      for (const BodyId body : balls) sum += energy(manager, body);
      return sum;
    };
    for (int step = 0; step < 120; ++step) {
      const double before = energy_of_all();
      manager.step(kFrame);
      EXPECT_LT(energy_of_all(), before + 20.0) << seed << ' ' << step;  // J
    }
  }
}

}  // namespace
}  // namespace lodestone
