// Blows through many bodies that lie on each other: what friction among them takes of a blow. The truth is
// ODE's, dWorldStep at steps of 1 ms (means of some seeds, from a program of its own).
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

Manager with_hulls(bool sleeping = true) {
  ManagerSettings settings = unmeasured();
  settings.sleeping = sleeping;
  Manager manager = on_floor(settings);
  manager.materials().set_law(0, 0, {.restitution = 0.2, .friction = 0.5});
  return manager;
}

double momentum_along_y(const Manager& manager, const std::vector<BodyId>& bodies) {
  double sum = 0.0;
  for (const BodyId body : bodies) sum += manager.mass(body) * manager.state(body).velocity.y();
  return sum;
}

// A pyramid of fifteen cubes: three of the lowest five are struck out of it, towards one side. N s of all,
// six frames later.
double momentum_of_struck_pyramid(bool sleeping) {
  constexpr double kCube = 0.3, kMass = 10.0, kSpeed = 4.0;  // m, kg, m/s
  constexpr int kRows = 5;
  Manager manager = with_hulls(sleeping);
  const auto cube = box_shape({kCube, kCube, kCube});
  std::vector<BodyId> bodies;
  for (int row = 0; row < kRows; ++row)
    for (int i = 0; i < kRows - row; ++i)
      bodies.push_back(manager.add_body(
          {.shape = cube,
           .state = testing::at({(i - 0.5 * (kRows - 1 - row)) * 0.32 + 0.002 * ((i + row) % 2),
                                 0.002 * ((i + 2 * row) % 3 - 1), 0.5 * kCube + kCube * row}),
           .mass = kMass,
           .level = LevelChoice::support}));
  run(manager, 0.5);
  for (const BodyId body : bodies) EXPECT_EQ(manager.asleep(body), sleeping);
  for (const std::size_t i : {1, 2, 3})
    manager.add_impulse(bodies[i], Vec3(0, kMass * kSpeed, 0), manager.state(bodies[i]).position);
  run(manager, 6 * kFrame);
  return momentum_along_y(manager, bodies);
}

TEST(BlowsThrough, SleepersSwallowNothingOfABlowAtTheFootOfAPyramid) {
  EXPECT_NEAR(momentum_of_struck_pyramid(true) / momentum_of_struck_pyramid(false), 1.0, 0.05);
}

}  // namespace
}  // namespace lodestone
