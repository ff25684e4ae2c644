// A sleeper on uneven triangles that is struck moves with what struck it, once a step.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tests/hills.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

// Until it was forgotten as they fell asleep that they lay there alone, one in seventeen was moved twice in
// the step that woke it, and one in a hundred read what was not there.
TEST(StruckOnTriangles, ASleeperMovesOnceAStep) {
  const auto cube = testing::box_shape({0.3, 0.3, 0.3});
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(0.08));
  int struck = 0;
  for (int start = 0; start < 100; ++start) {
    RandomStream random(5, std::uint64_t(start), 0);
    Manager manager(testing::unmeasured());
    manager.add_static_mesh(testing::make_hills(20, 20));
    RigidState state;
    state.position = {random.uniform(-6, 6), random.uniform(-6, 6), 0.0};
    state.position.z() = testing::height_of_hills(state.position.x(), state.position.y()) + 0.12;
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ()));
    const BodyId sleeper = testing::add(manager, cube, state, LevelChoice::support);
    testing::run(manager, 4.0);
    if (!manager.asleep(sleeper)) continue;
    const double around = random.uniform(0, 2 * std::numbers::pi), down = random.uniform(0.15, 0.6);
    const Vec3 way(std::cos(around) * std::cos(down), std::sin(around) * std::cos(down), -std::sin(down));
    RigidState thrown;
    thrown.position = manager.state(sleeper).position - random.uniform(0.6, 1.4) * way;
    thrown.velocity = 15.0 * way;
    manager.add_body({.shape = ball, .state = thrown, .mass = 5.0, .level = LevelChoice::support});
    for (int i = 0; i < 15; ++i) {
      const Vec3 before = manager.state(sleeper).position;
      manager.step(testing::kFrame);
      const double moved = (manager.state(sleeper).position - before).norm();
      if (moved < 1e-3) continue;
      EXPECT_LT(moved, 1.3 * manager.state(sleeper).velocity.norm() * testing::kFrame) << start;
      ++struck;
      break;
    }
  }
  EXPECT_GT(struck, 60);
}

// Ground that moves is met by each of its triangles; together they push a body out once.
TEST(StruckOnTriangles, ADeckThatMovesPushesOutOnce) {
  constexpr double kDeckCube = 0.4, kSunkBy = 0.03, kDeckCell = 0.1, kDeckSpeed = 0.5;  // m, m/s
  Mesh deck;
  constexpr int kDeckCells = 40;
  for (int i = 0; i <= kDeckCells; ++i)
    for (int k = 0; k <= kDeckCells; ++k)
      deck.vertices.push_back({kDeckCell * (i - kDeckCells / 2), kDeckCell * (k - kDeckCells / 2), 0});
  for (int i = 0; i < kDeckCells; ++i)
    for (int k = 0; k < kDeckCells; ++k) {
      const int a = i * (kDeckCells + 1) + k, b = a + kDeckCells + 1;
      deck.faces.push_back({a, b, a + 1}), deck.faces.push_back({b, b + 1, a + 1});
    }
  Manager manager(testing::unmeasured());
  const GroundId ground = manager.add_static_mesh(deck);
  std::vector<BodyId> cubes;
  for (int i = 0; i < 2; ++i)
    cubes.push_back(
        testing::add(manager, testing::box_shape({kDeckCube, kDeckCube, kDeckCube}),
                     testing::at({kDeckCube * i, 0, 0.5 * kDeckCube - kSunkBy}, {kDeckSpeed, 0, 0}),
                     LevelChoice::support));
  for (int step = 0; step < 30; ++step) {
    manager.move_ground(ground, testing::at({kDeckSpeed * step * testing::kFrame, 0, 0}, {kDeckSpeed, 0, 0}));
    manager.step(testing::kFrame);
    for (const BodyId cube : cubes)
      EXPECT_LT(manager.state(cube).position.z(), 0.5 * kDeckCube + 0.005) << step;
  }
}

}  // namespace
}  // namespace lodestone
