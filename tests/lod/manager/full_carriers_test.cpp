// A kinematic slab with full cubes on it: their rung becomes its own.
#include "lod/manager/full_carriers.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kSideOfCube = 0.3;  // m, of a cube

struct Slab {
  explicit Slab(LevelChoice level, int count = 60)
      : manager(unmeasured({.policy = DistancePolicy{.full_within = 0.01}})) {
    view_from(manager, {0, 0, 50});
    slab = manager.add_body({.shape = box_shape({12, 12, 0.5}),
                             .state = testing::at({0, 0, -0.25}),
                             .level = level,
                             .properties = {.kinematic = true}});
    std::mt19937 random(1);
    const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
    for (int i = 0; i < count; ++i) {
      RigidState state = testing::at({0.45 * (i % 4 - 1.5), 0.45 * (i / 4 % 4 - 1.5), 0.45 * (i / 16) + 0.3});
      state.orientation = Quat(some(), some(), some(), some()).normalized();
      cubes.push_back(add(manager, box_shape(Vec3::Constant(kSideOfCube)), state, LevelChoice::full));
    }
  }
  double lowest() const {
    double lowest = 1e9;
    for (const BodyId cube : cubes) {
      const RigidState state = manager.state(cube);
      const Vec3 down = state.orientation.conjugate() * Vec3::UnitZ();
      lowest = std::min(lowest, state.position.z() - 0.5 * kSideOfCube * down.cwiseAbs().sum());
    }
    return lowest;
  }
  int asleep() const {
    return int(std::ranges::count_if(cubes, [&](BodyId cube) { return manager.asleep(cube); }));
  }

  Manager manager;
  BodyId slab;
  std::vector<BodyId> cubes;
};

TEST(FullCarriers, ASlabUnderFullCubesIsFullAsLongAsTheyAreThere) {
  Slab scene(LevelChoice::automatic);
  scene.manager.step(kFrame);
  EXPECT_EQ(scene.manager.rung(scene.slab), Rung::support);
  run(scene.manager, 8.0);
  EXPECT_EQ(scene.manager.explain(scene.slab).rung, Rung::full);
  EXPECT_EQ(scene.manager.explain(scene.slab).rule, Rule::carries_full);
  EXPECT_EQ(scene.asleep(), 60);
  EXPECT_GT(scene.lowest(), -0.002);
  for (const BodyId cube : scene.cubes) scene.manager.remove_body(cube);
  run(scene.manager, 1.0);
  EXPECT_EQ(scene.manager.rung(scene.slab), Rung::support);
}

TEST(FullCarriers, TheCallersChoiceGoesFirst) {
  Slab scene(LevelChoice::support, 2);
  run(scene.manager, 2.0);
  EXPECT_EQ(scene.manager.rung(scene.slab), Rung::support);
}

// Overlaps are judged by the smaller of two bodies: by the radius of the slab these would be none up to 17
// mm.
TEST(FullCarriers, CubesDoNotSinkIntoALargeSlabThatIsStatistical) {
  for (const int count : {2, 4, 16}) {
    Slab scene(LevelChoice::support, count);
    run(scene.manager, 4.0);
    EXPECT_GT(scene.lowest(), -0.002) << count;
    EXPECT_EQ(scene.asleep(), count);
  }
}

}  // namespace
}  // namespace lodestone
