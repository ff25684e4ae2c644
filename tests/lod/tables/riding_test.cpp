// Stacks of `tables` on what carries them.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace lodestone::riding_test
