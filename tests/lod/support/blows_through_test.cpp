// Blows through many bodies that lie on each other: what friction among them takes of a blow. The truth is
// ODE's, dWorldStep at steps of 1 ms (means of some seeds, from a program of its own).
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "reference/random.h"
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

// It lands at the very end of a step, on the ground to rounding, while another strikes it from the side: it
// bounces all the same.
TEST(BlowsThrough, WhoLandsAsItIsStruckBounces) {
  constexpr double kBallRadius = 0.15;  // m
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kBallRadius));
  for (const double dt : {1.0 / 60, 1.0 / 240})
    for (std::uint32_t i = 0; i < 60; ++i) {
      RandomStream random(4, i, 0);
      ManagerSettings settings = unmeasured();
      settings.gravity = Vec3::Zero();
      Manager manager(settings);
      manager.materials().replace(0, {.restitution = 1.0, .friction = 0.0});
      manager.add_plane(Vec3::UnitZ(), 0.0);
      const double lands = 0.1, late = random.uniform(-0.008, 0.008), falls = random.uniform(2, 4),
                   comes = random.uniform(2, 4), height = kBallRadius + falls * lands;
      const BodyId first =
          add(manager, ball, testing::at({0, 0, height}, {0, 0, -falls}), LevelChoice::support);
      add(manager, ball,
          testing::at({-2.0 * kBallRadius - comes * (lands + late), random.uniform(-0.05, 0.05), height},
                      {comes, 0, -0.999 * falls}),
          LevelChoice::support);
      for (double t = 0.0; t < 0.4; t += dt) manager.step(dt);
      EXPECT_GT(manager.state(first).velocity.z(), 0.5 * falls) << dt << ' ' << i;
    }
}

}  // namespace
}  // namespace lodestone
