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

INSTANTIATE_TEST_SUITE_P(Levels, GuestsBear, ::testing::Values(LevelChoice::full, LevelChoice::support));

}  // namespace
}  // namespace lodestone
