// Hulls that lie on heaps of `tables`.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCubeSide = 0.3, kCubeMass = 8.0;  // m and kg

class GuestsBear : public ::testing::TestWithParam<LevelChoice> {};

TEST_P(GuestsBear, ACubeOfTheirOwnWeightAndOneOfTwice) {
  for (const double weights : {1.0, 2.0}) {
    Manager manager = on_floor({.signatures = coarse_signature});
    const auto cube = box_shape({kCubeSide, kCubeSide, kCubeSide});
    for (int i = 0; i < 32; ++i)
      manager.add_body({.shape = cube,
                        .state = testing::at({0.301 * (i % 4), 0.301 * (i / 4 % 4), 0.15 + 0.301 * (i / 16)}),
                        .mass = kCubeMass,
                        .level = LevelChoice::tables});
    const BodyId above = manager.add_body({.shape = cube,
                                           .state = testing::at({0.45, 0.45, 0.76}),
                                           .mass = weights * kCubeMass,
                                           .level = GetParam()});
    run(manager, 12.0);
    EXPECT_NEAR(manager.state(above).position.z(), 2.5 * kCubeSide, 0.02) << weights << " weights";
    EXPECT_TRUE(manager.asleep(above)) << weights << " weights";
  }
}

// Guests are moved in substeps. While what bore them was given at the first, the middle one of three hovered
// a millimetre above the lowest at .054 m/s downwards; and as nothing resisted its turning, all fell within
// five seconds.
TEST_P(GuestsBear, AHullOnTwoOfThemForGoodThoughNobodySleeps) {
  for (const double weights : {0.1, 1.0}) {
    Manager manager = on_floor({.sleeping = false, .signatures = coarse_signature});
    const auto cube = box_shape({kCubeSide, kCubeSide, kCubeSide});
    std::vector<BodyId> tower;
    for (int i = 0; i < 3; ++i)
      tower.push_back(
          manager.add_body({.shape = cube,
                            .state = testing::at({0, 0, (i + 0.5) * kCubeSide + (i == 2 ? 0.002 : 0.0)}),
                            .mass = i == 2 ? weights * kCubeMass : kCubeMass,
                            .level = i == 2 ? GetParam() : LevelChoice::tables}));
    run(manager, 5.0);
    for (std::size_t i = 0; i < tower.size(); ++i) {
      const RigidState state = manager.state(tower[i]);
      EXPECT_NEAR(state.position.z(), (double(i) + 0.5) * kCubeSide, 0.002) << weights << " weights";
      EXPECT_LT(state.velocity.norm(), 0.005) << weights << " weights";
    }
  }
}

// It slides by v² / (2 μ g). Where nothing resisted the turning of what it lies on, a push of .3 m/s threw
// all three down.
TEST_P(GuestsBear, AHullThatSlidesOnTwoOfThemStopsAndAllSleep) {
  for (const double speed : {0.3, 1.0}) {
    Manager manager = on_floor({.signatures = coarse_signature});
    const auto cube = box_shape({kCubeSide, kCubeSide, kCubeSide});
    std::vector<BodyId> tower;
    for (int i = 0; i < 3; ++i)
      tower.push_back(manager.add_body({.shape = cube,
                                        .state = testing::at({0, 0, (i + 0.5) * kCubeSide}),
                                        .mass = kCubeMass,
                                        .level = i == 2 ? GetParam() : LevelChoice::tables}));
    run(manager, 3.0);
    const Vec3 from = manager.state(tower[2]).position;
    manager.add_impulse(tower[2], Vec3(kCubeMass * speed, 0, 0), from);
    run(manager, 2.0);
    const RigidState after = manager.state(tower[2]);
    const double friction = 0.5;
    EXPECT_NEAR(after.position.x() - from.x(), speed * speed / (2 * friction * 9.81), 0.015) << speed;
    EXPECT_NEAR(after.position.z(), 2.5 * kCubeSide, 0.006) << speed;
    for (const BodyId body : tower) EXPECT_TRUE(manager.asleep(body)) << speed;
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, GuestsBear, ::testing::Values(LevelChoice::full, LevelChoice::support));

}  // namespace
}  // namespace lodestone
