// Pairs that the caller's filter lets through each other at the full level.
#include <gtest/gtest.h>

#include "lod/full/full_level.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::full_level_filter_test {
namespace {

using namespace testing;

TEST(FullLevel, AsksTheFilterByTheManagersIndices) {
  const MaterialTable materials = material(0.0, 0.5);
  FullLevel level({}, materials);
  level.set_pair_filter([](std::uint32_t a, std::uint32_t b) { return a + b != 7 + 9; });
  level.add_plane({}, HalfSpace{.normal = Vec3::UnitZ(), .offset = 0.0, .material = 0});
  const auto shape = box_shape({0.4, 0.4, 0.4});
  std::vector<OdeBodyId> bodies;
  for (const auto& [owner, x, z] : {std::tuple(7u, 0.0, 0.2), std::tuple(9u, 0.0, 0.8),
                                    std::tuple(3u, 5.0, 0.2), std::tuple(4u, 5.0, 0.8)})
    bodies.push_back(level.add(owner, {.shape = shape, .mass = 64.0, .state = at({x, 0, z})}, false));
  Counters counters;
  for (int i = 0; i < 120; ++i) level.step(1.0 / 60, counters);
  EXPECT_NEAR(level.world()->state(bodies[1]).position.z(), 0.2, 2e-3);
  EXPECT_NEAR(level.world()->state(bodies[3]).position.z(), 0.6, 2e-3);
}

}  // namespace
}  // namespace lodestone::full_level_filter_test
