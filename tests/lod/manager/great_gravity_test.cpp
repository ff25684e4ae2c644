// Ground holds what falls on it, on every rung, where a step takes a body farther than its size.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

TEST(GreatGravity, GroundHoldsABoxOnEveryRung) {
  static const auto shape = box_shape({0.2, 0.3, 0.4});
  static const auto signature = coarse_signature(*shape, {});
  for (const auto& [gravity, height] :
       {std::pair(100.0, 0.5), {1e3, 3.0}, {1e3, 10.0}, {1e4, 0.3}, {1e4, 3.0}})
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
      ManagerSettings settings{.gravity = {0, 0, -gravity}};
      settings.signatures = [](const Shape&, const ContactLaw&) { return signature; };
      Manager manager = on_floor(settings);
      const BodyId body = add(manager, shape, testing::at({0, 0, height}, {0.6, 0, 0}, {2, 4, 3}), level);
      double lowest = height;
      for (int i = 0; i < 120; ++i) {
        manager.step(kFrame);
        lowest = std::min(lowest, manager.state(body).position.z());
      }
      EXPECT_GT(lowest, 0.0) << gravity << ", " << int(level);
      EXPECT_LT(manager.state(body).position.z(), 0.5) << gravity << ", " << int(level);
    }
}

}  // namespace
}  // namespace lodestone
