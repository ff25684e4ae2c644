// Much heavier balls of `tables` that land on a light one.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// It was driven down by the one above it, which followed: that counted as a way into what it had not met, so
// that it was put back to where it had been and held there, while the others went through it; pushed out,
// they gained .13 of all energy.
TEST(LightUnderHeavy, IsNotHeldInTheAir) {
  constexpr double kRadius = 0.2025;  // m
  constexpr double kMass[] = {3.98, 34.8, 64.3}, kHeight[] = {0.81, 1.755, 2.7};
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  double worst = 0.0;  // gain over the whole
  for (int way = 0; way < 23; ++way) {
    Manager manager = on_floor({.signatures = coarse_signature});
    std::vector<BodyId> column;
    for (int i = 0; i < 3; ++i)
      column.push_back(manager.add_body({.shape = ball,
                                         .state = at({0, 0, kHeight[i] + 0.001 * ((way * 7 + i * 13) % 23)}),
                                         .mass = kMass[i],
                                         .level = LevelChoice::tables}));
    const auto energy_of_all = [&] {
      double sum = 0.0;
      for (const BodyId body : column) sum += energy(manager, body);
      return sum;
    };
    const double whole = energy_of_all();
    double least = whole;
    for (int frame = 0; frame < 100; ++frame) {
      manager.step(kFrame);
      least = std::min(least, energy_of_all());
      worst = std::max(worst, (energy_of_all() - least) / whole);
    }
  }
  EXPECT_LT(worst, 0.05);
}

}  // namespace
}  // namespace lodestone
