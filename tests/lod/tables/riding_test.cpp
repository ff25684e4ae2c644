// Stacks of `tables` on what carries them.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::riding_test {
namespace {

using namespace testing;

// On a carrier .2 m high wide slabs were drawn as spheres that touched the ground below it, which held them.
TEST(Riding, StacksOfWideSlabsGoWithTheirCarrier) {
  for (const double thickness : {0.1, 0.15, 0.25})
    for (const int count : {1, 2, 4}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      const BodyId carrier = manager.add_body({.shape = box_shape({3, 3, 0.2}),
                                               .state = testing::at({0, 0, 0.1}),
                                               .level = LevelChoice::support,
                                               .properties = {.kinematic = true}});
      const auto slab = box_shape({0.5, 0.5, thickness});
      std::vector<BodyId> stack;
      for (int i = 0; i < count; ++i)
        stack.push_back(add(manager, slab, testing::at({0.01 * (i % 2), 0, 0.2 + thickness * (i + 0.5)}),
                            LevelChoice::tables));
      run(manager, 1.5);
      for (int frame = 0; frame < 120; ++frame) {
        RigidState state = manager.state(carrier);
        state.velocity = {std::min(0.5, frame / 60.0), 0, 0};
        manager.set_state(carrier, state);
        manager.step(kFrame);
      }
      const double way = manager.state(carrier).position.x();
      ASSERT_GT(way, 0.8);
      for (const BodyId body : stack)
        EXPECT_NEAR(manager.state(body).position.x(), way, 0.05) << thickness << ", of " << count;
    }
}

// It slept before it was fast enough to be seen to move, as what has just ceased to slide does.
TEST(Riding, WhatFrictionDoesNotHoldSlidesOffATiltedCarrier) {
  constexpr double kMu = 0.2, kSeconds = 2.0, kG = 9.81;  // –, s, m/s²
  for (const double size : {0.2, 0.4, 1.0})
    for (const double over : {1.15, 1.5}) {
      Manager manager(ManagerSettings{.signatures = coarse_signature});
      manager.materials().replace(0, {.restitution = 0.0, .friction = kMu});
      const double angle = std::atan(over * kMu);
      const Quat tilted(Eigen::AngleAxisd(angle, Vec3::UnitY()));
      manager.add_body({.shape = box_shape({40, 10, 1}),
                        .state = {.position = tilted * Vec3(0, 0, -0.5), .orientation = tilted},
                        .level = LevelChoice::support,
                        .properties = {.kinematic = true}});
      const BodyId crate =
          add(manager, box_shape({size, size, 0.5 * size}),
              {.position = tilted * Vec3(0, 0, 0.25 * size), .orientation = tilted}, LevelChoice::tables);
      run(manager, kSeconds);
      const double expected = 0.5 * kG * (std::sin(angle) - kMu * std::cos(angle)) * kSeconds * kSeconds;
      const double way = (tilted.inverse() * manager.state(crate).position).x();
      EXPECT_NEAR(way / expected, 1.0, 0.05) << size << " at " << over << " times what holds";
    }
}

}  // namespace
}  // namespace lodestone::riding_test
