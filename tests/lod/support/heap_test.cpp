// Heaps at `support` in which bodies differ by much, are small, or fall hard: none sinks into its neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "reference/hull/hull_overlap.h"
#include "reference/shape.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

struct Heap {
  Manager manager;
  std::vector<BodyId> bodies;
  double side = 0.0;  // m

  // Cubes poured into a bin, of masses in turn.
  Heap(double side_m, std::span<const double> masses, unsigned seed, double gravity = 9.81)
      : manager(settings(gravity)), side(side_m) {
    const double half = 4.0 * side;
    manager.add_plane(Vec3::UnitZ(), 0.0);
    for (const Vec3& wall : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
      manager.add_plane(wall, -half);
    const auto cube = std::make_shared<const Shape>(make_shape("cube", make_box(Vec3::Constant(side))));
    std::mt19937 random(seed);
    const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
    for (int i = 0; i < 120; ++i) {
      RigidState state;
      state.position = {2.0 * side * (i % 4 - 1.5), 2.0 * side * (i / 4 % 4 - 1.5),
                        2.0 * side * (i / 16 + 1)};
      state.position += 0.1 * side * Vec3(some(), some(), some());
      state.orientation = Quat(some(), some(), some(), some()).normalized();
      BodyDefinition definition{.shape = cube, .state = state, .level = LevelChoice::support};
      definition.mass = masses[std::size_t(i * 7 + i / 3) % masses.size()];
      bodies.push_back(manager.add_body(definition));
    }
  }
  static ManagerSettings settings(double gravity) {
    ManagerSettings settings = testing::unmeasured();
    settings.gravity = {0, 0, -gravity};
    return settings;
  }
  // Over the side: of two of them, after `seconds`.
  double deepest_overlap(double seconds) {
    testing::run(manager, seconds);
    double deepest = 0.0;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        const RigidState one = manager.state(bodies[i]), other = manager.state(bodies[k]);
        if ((one.position - other.position).norm() < 1.74 * side)
          deepest = std::max(
              deepest, measure_hull_overlap(manager.shape(bodies[i]), one, manager.shape(bodies[k]), other));
      }
    return deepest / side;
  }
};

// What sinks in between light ones while they land, no later step takes out again.
TEST(Heap, HeavyBodiesDoNotSinkIntoLightOnes) {
  for (const double ratio : {1.0, 4.0, 8.0, 19.0}) {
    const std::array masses{8.0, 8.0 * ratio, 8.0 * std::sqrt(ratio)};
    double deepest = 0.0;
    for (const unsigned seed : {1U, 2U}) deepest += 0.5 * Heap(0.2, masses, seed).deepest_overlap(4.0);
    EXPECT_LT(deepest, ratio < 10.0 ? 0.08 : 0.15) << ratio;
  }
}

// By gravity, in a step of 1/60 s, a centimetre falls a third of its size, and twenty times as hard does a
// crate.
TEST(Heap, SmallBodiesDoNotSinkIntoEachOther) {
  const std::array centimetres{1e-3};
  int asleep = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    Heap heap(0.01, centimetres, seed);
    EXPECT_LT(heap.deepest_overlap(4.0), 0.14);
    asleep += heap.manager.report().asleep;
  }
  EXPECT_GE(asleep, 300);  // of 360
}

TEST(Heap, NorDoThoseThatFallHard) {
  const std::array crates{8.0};
  EXPECT_LT(Heap(0.2, crates, 1, 20 * 9.81).deepest_overlap(4.0), 0.14);
}

// What was swept, and how long, was a matter of all heaps of unlike bodies together: beside 19 others the
// slab sank into its cubes by .8 mm, which it does not alone.
TEST(Heap, OfUnlikeBodiesIsNoMatterOfOthersElsewhere) {
  Manager manager(testing::unmeasured());
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto cube = testing::box_shape({0.1, 0.1, 0.1}), slab = testing::box_shape({1, 1, 0.4});
  BodyId first;
  for (int k = 0; k < 20; ++k) {
    const Vec3 place(10.0 * k, 0, 0);
    for (int i = 0; i < 3; ++i) {
      const double angle = 2.0944 * i;
      testing::add(manager, cube,
                   testing::at(place + Vec3(0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.051)),
                   LevelChoice::support);
    }
    const BodyId added =
        testing::add(manager, slab, testing::at(place + Vec3(0.05, 0, 0.303)), LevelChoice::support);
    if (k == 0) first = added;
  }
  testing::run(manager, 10.0);
  EXPECT_NEAR(manager.state(first).position.z(), 0.3, 1e-4);
  EXPECT_TRUE(manager.asleep(first));
}

}  // namespace
}  // namespace lodestone
