// What rocks on its belly goes on as long as in ODE, or nearly, where no clip takes over.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::rocking_test {
namespace {

using namespace testing;

// rad²/s², mean of a hundred bunnies that fell onto a slope of 5 degrees three seconds ago.
double squared_spin_after_a_fall(LevelChoice level) {
  constexpr double kSlope = 5.0 / 180.0 * std::numbers::pi, kApart = 5.0, kHeight = 0.13;  // rad, m, m
  const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2));
  Manager manager(unmeasured());
  manager.add_plane({std::sin(kSlope), 0.0, std::cos(kSlope)}, 0.0);
  RandomStream random(5, 0, 0);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 100; ++i) {
    const double x = kApart * (i % 10), y = kApart * int(i / 10);
    const Vec3 position(x, y, kHeight - x * std::tan(kSlope));
    bodies.push_back(add(manager, bunny, {.position = position, .orientation = random.orientation()}, level));
  }
  run(manager, 3.0);
  double sum = 0.0;
  for (const BodyId body : bodies) sum += manager.state(body).angular_velocity.squaredNorm();
  return sum / double(bodies.size());
}

// A step that rolls onto a vertex gains what the one before lost: bounded one by one, steps took from all
// that rocked.
TEST(Rocking, OnASlopeIsBoundedFromStrikeToStrike) {
  const double spin = squared_spin_after_a_fall(LevelChoice::support);
  EXPECT_GT(spin, 0.1);  // so .2, else .05
  EXPECT_LT(spin, 0.6);  // at full .4
}

}  // namespace
}  // namespace lodestone::rocking_test
