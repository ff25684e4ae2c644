// Round bodies that lie against each other, each island in steps of a whole frame.
#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::layer_of_bunnies_test {
namespace {

using namespace testing;

// Bodies asleep of 150 that fell onto 3.5 × 3.5 m, so that most of them lean on others.
int asleep_after(double seconds, std::uint64_t seed) {
  static const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2));
  Manager manager = on_floor();
  RandomStream random(seed, 0, 0);
  for (int i = 0; i < 150; ++i) {
    const Vec3 position(random.uniform(-1.75, 1.75), random.uniform(-1.75, 1.75), random.uniform(0.5, 3.0));
    add(manager, bunny, {.position = position, .orientation = random.orientation()}, LevelChoice::support);
  }
  run(manager, seconds);
  return manager.report().asleep;
}

// A bunny that tips meets the ground with vertices between those that lie widest. Where they were no contacts
// it sank in and was lifted out again, which gave it what it lost in the next impact: many hopped on.
TEST(LayerOfBunnies, ComesToRest) {
  int asleep = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) asleep += asleep_after(4.0, seed);
  // Of 600. In ODE, in eight substeps with the first seed, 99 of 150; here 370, 227 without these vertices,
  // and 460 while what rolled lost too much.
  EXPECT_GT(asleep, 320);
  EXPECT_LT(asleep, 430);
}

}  // namespace
}  // namespace lodestone::layer_of_bunnies_test
