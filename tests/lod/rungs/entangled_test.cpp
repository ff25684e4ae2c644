// Concave bodies that are in each other, as they may be where they come from `tables`.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/four_legged.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// Tables that fall into a bin of planes, turned anyhow.
struct FullPour {
  FullPour(unsigned seed, int count, double half_side) : manager(on_floor()) {
    for (const Vec3& inward : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())})
      manager.add_plane(inward, -half_side), manager.add_plane(-inward, -half_side);
    std::mt19937 random(seed);
    const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
    for (int i = 0; i < count; ++i) {
      RigidState state = testing::at({0.9 * (i % 2) - 0.45, 0.9 * (i / 2 % 2) - 0.45, 0.6 + 0.9 * (i / 4)});
      const Eigen::Vector4d turn(some(), some(), some(), some());
      state.orientation = Quat(turn[0], turn[1], turn[2], turn[3]).normalized();
      bodies.push_back(add(manager, shape, state, LevelChoice::full));
    }
  }
  std::shared_ptr<const Shape> shape = four_legged_shape();
  Manager manager;
  std::vector<BodyId> bodies;
};

// A leg through the other's plate: pushed out of it both ways, they stayed where they were, and awake.
TEST(Entangled, WhatIsStuckInAnotherComesToRest) {
  const auto shape = four_legged_shape();
  for (const double over : {0.05, 0.1, 0.2}) {
    Manager manager = on_floor();
    RigidState upper = testing::at({0.15, 0.13, 0.425 + over});
    upper.orientation = Eigen::AngleAxisd(0.3, Vec3::UnitZ());
    const std::vector<BodyId> both{add(manager, shape, testing::at({0, 0, 0.375}), LevelChoice::support),
                                   add(manager, shape, upper, LevelChoice::support)};
    run(manager, 4.0);
    for (const BodyId body : both) EXPECT_TRUE(manager.asleep(body)) << over;
  }
}

// 8,578 m/s, of a kick of 2.4 at most.
TEST(Entangled, HeapsThatComeNearAndAreStruckThrowNobody) {
  const auto shape = four_legged_shape();
  std::mt19937 random(3);
  const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  Manager manager = on_floor({.signatures = coarse_signature});
  std::vector<BodyId> bodies;
  for (int heap = 0; heap < 24; ++heap)
    for (int i = 0; i < 12; ++i) {
      RigidState state = testing::at({4.0 * heap, 0.2 * some(), 0.5 + 0.9 * i});
      state.orientation = Quat(some(), some(), some(), some()).normalized();
      bodies.push_back(add(manager, shape, state, LevelChoice::tables));
    }
  run(manager, 6.0);
  for (const BodyId body : bodies) manager.set_level(body, LevelChoice::support);
  run(manager, 0.5);
  for (const BodyId body : bodies)
    manager.add_impulse(body, manager.mass(body) * Vec3(some(), some(), 1.0 + some()),
                        manager.state(body).position);
  double fastest = 0.0;  // m/s
  for (int i = 0; i < 240; ++i) {
    manager.step(kFrame);
    for (const BodyId body : bodies) fastest = std::max(fastest, manager.state(body).velocity.norm());
  }
  EXPECT_LT(fastest, 3.0);
}

// Full: what contacts gave that held a leg on both sides of a plate grew without bound, to 12.9 and 15.5 m/s
// here, to 150 km/s of thinner ones.
TEST(Entangled, NobodyIsThrownOfThosePouredAtFull) {
  for (const unsigned seed : {13u, 92u}) {
    FullPour pour(seed, 12, 0.85);
    double fastest = 0.0;  // m/s
    for (int i = 0; i < 120; ++i) {
      pour.manager.step(kFrame);
      for (const BodyId body : pour.bodies)
        fastest = std::max(fastest, pour.manager.state(body).velocity.norm());
    }
    EXPECT_LT(fastest, 7.0) << seed;  // they fall at 5
  }
}

// Brackets on each other: tipped into the lower one, lifted out of it and tipped again as they sank, one pair
// in forty walked about for ever.
TEST(Entangled, PairsOfBracketsComeToRestAtTables) {
  Manager manager = on_floor({.signatures = coarse_signature});
  const auto bracket = std::make_shared<const Shape>(make_shape("bracket", make_l(0.4, 0.4, 0.08, 0.12)));
  std::mt19937 random(1);
  const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  std::vector<BodyId> bodies;
  for (int i = 0; i < 2400; ++i) {
    RigidState state = testing::at({3.0 * (i / 2 % 40), 3.0 * (i / 80), 0.4 + 0.7 * (i % 2)});
    state.velocity = 0.3 * Vec3(some(), some(), 0);
    state.orientation = Quat(some(), some(), some(), some()).normalized();
    bodies.push_back(add(manager, bracket, state, LevelChoice::tables));
  }
  run(manager, 30.0);
  EXPECT_EQ(manager.report().asleep, int(bodies.size()));
}

}  // namespace
}  // namespace lodestone
