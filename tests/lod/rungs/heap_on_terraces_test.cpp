// A heap on ground of several heights, that sleeps, and is fallen on.
#include <gtest/gtest.h>

#include <random>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::heap_on_terraces_test {
namespace {

using namespace testing;

// Who was woken last in a step, in a heap of many contacts, was put on the faces below somebody else: .6 or
// 1.2 m up.
TEST(HeapOnTerraces, NobodyIsLiftedOntoTheGroundOfOthers) {
  constexpr double kStep = 0.6, kJump = 0.05;  // m
  Manager manager(unmeasured());
  for (int i = 0; i < 8; ++i)
    manager.add_static_box({4, 30, 1}, {4.0 * i - 14, 0, kStep * (i % 3) - 0.5}, Quat::Identity(), 0);
  const auto box = box_shape({0.3, 0.3, 0.3});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 512; ++i)
    bodies.push_back(add(
        manager, box, testing::at({-5 + 0.31 * (i / 32), -2.5 + 0.31 * (i / 2 % 16), 0.3 + 0.31 * (i % 2)}),
        LevelChoice::support));
  run(manager, 4.0);
  std::mt19937 random(1);
  const auto within = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  for (int i = 0; i < 30; ++i)
    bodies.push_back(manager.add_body(
        {.shape = box,
         .state = {.position = {within(-5, 0.5), within(-2.6, 2.9), 3 + 0.4 * i}, .velocity = {0, 0, -10}},
         .mass = 200.0,
         .level = LevelChoice::support}));
  std::vector<RigidState> before(bodies.size());
  for (int frame = 0; frame < 120; ++frame) {
    for (std::size_t k = 0; k < bodies.size(); ++k) before[k] = manager.state(bodies[k]);
    manager.step(kFrame);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const RigidState now = manager.state(bodies[k]);
      const double up = now.position.z() - before[k].position.z();
      ASSERT_LT(up - kFrame * std::max({0.0, now.velocity.z(), before[k].velocity.z()}), kJump)
          << "body " << k << ", frame " << frame;
    }
  }
}

}  // namespace
}  // namespace lodestone::heap_on_terraces_test
