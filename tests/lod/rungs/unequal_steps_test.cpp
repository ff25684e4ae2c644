// Steps of a game that spends what is left of a frame: short ones among longer ones.
#include <gtest/gtest.h>

#include <algorithm>

#include "reference/mesh/mesh.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

class UnequalSteps : public ::testing::TestWithParam<LevelChoice> {
 protected:
  static Manager poured(std::vector<BodyId>& bodies, int count) {
    ManagerSettings settings = unmeasured();
    settings.signatures = coarse_signature;
    settings.signature_timing = SignatureTiming::in_step;
    Manager manager = on_floor(settings);
    const auto crate = box_shape({0.2, 0.3, 0.4});
    RandomStream random(5, 0, 0);
    for (int i = 0; i < count; ++i) {
      const Vec3 place(0.55 * (i % 4), 0.55 * (i / 4 % 4), 0.5 + 0.5 * (i / 16));
      bodies.push_back(manager.add_body({.shape = crate,
                                         .state = {.position = place, .orientation = random.orientation()},
                                         .level = GetParam()}));
    }
    return manager;
  }
  static double fastest(const Manager& manager, std::span<const BodyId> bodies) {
    double most = 0.0;
    for (const BodyId body : bodies) most = std::max(most, manager.state(body).velocity.norm());
    return most;
  }
};

// Greatest speeds of a pile that was poured: of what falls from 1.5 m, 5.4 m/s.
TEST_P(UnequalSteps, NobodyIsThrown) {
  constexpr double kFrames[][2] = {{kFrame, 1e-6}, {0.05, 0.004}, {1.0 / 30.0, 5e-4}};
  for (const auto& [frame, rest] : kFrames) {
    std::vector<BodyId> bodies;
    Manager manager = poured(bodies, GetParam() == LevelChoice::full ? 32 : 60);
    double most = 0.0;
    for (double time = 0.0; time < 6.0; time += frame + rest) {
      manager.step(frame);
      manager.step(rest);
      if (time > 1.0) most = std::max(most, fastest(manager, bodies));
    }
    EXPECT_LT(most, 5.4) << frame << ' ' << rest;
  }
}

// As one who wakes a heap and steps on by nearly nothing.
TEST_P(UnequalSteps, AShortStepGivesAHeapNoEnergy) {
  std::vector<BodyId> bodies;
  Manager manager = poured(bodies, 40);
  run(manager, 5.0);
  for (const BodyId body : bodies) manager.wake(body);
  manager.step(1e-5);
  double energy = 0.0;  // J, of 24 kg each
  for (const BodyId body : bodies)
    energy += 0.5 * manager.mass(body) * manager.state(body).velocity.squaredNorm();
  EXPECT_LT(energy, 4.0);
}

INSTANTIATE_TEST_SUITE_P(Rungs, UnequalSteps,
                         ::testing::Values(LevelChoice::full, LevelChoice::support, LevelChoice::tables));

}  // namespace
}  // namespace lodestone
