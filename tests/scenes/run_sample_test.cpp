#include "scenes/run_sample.h"

#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

// Bodies of a manager over the plane z = 0, and the scene that they are of.
struct Sampled {
  Sampled() { scene.ground = {GroundPlane{Vec3::UnitZ(), 0.0, 0}}; }
  void add(const std::shared_ptr<const Shape>& shape, const RigidState& state, LevelChoice level) {
    SceneBody& body = scene.bodies.emplace_back();
    body.definition = {.shape = shape, .state = state, .level = level};
    bodies.push_back(manager.add_body(body.definition));
  }
  void read() { read_sample(manager, bodies, scene, sample); }
  Manager manager = testing::on_floor();
  Scene scene;
  std::vector<BodyId> bodies;
  RunSample sample;
};

// ½ m v² + ½ ω·Iω + m g z, of the bodies as they are given.
TEST(RunSample, EnergyIsThatOfMotionAndHeight) {
  Sampled scene;
  const auto cube = testing::box_shape({0.2, 0.2, 0.2});
  scene.add(cube, testing::at({0, 0, 2}, {3, 0, 0}, {0, 0, 4}), LevelChoice::automatic);
  scene.add(cube, testing::at({5, 0, 1}), LevelChoice::automatic);
  scene.read();
  const double mass = scene.manager.mass(scene.bodies[0]), g = -scene.scene.step.gravity_m_per_s2.z();
  EXPECT_NEAR(scene.sample.energy_j, mass * (4.5 + 0.5 * 16 * 0.04 / 6 + g * 3), 1e-9 * mass);
  EXPECT_TRUE(scene.sample.finite);
  EXPECT_EQ(scene.sample.max_other_penetration_m, 0.0);
  EXPECT_EQ(scene.sample.states[1].position, Vec3(5, 0, 1));
}

TEST(RunSample, DepthIsThatOfTheLowestPointBelowAnyPlane) {
  Sampled scene;
  scene.scene.ground.emplace_back(GroundPlane{Vec3::UnitX(), -1.0, 0});  // a wall at x = −1
  const auto cube = testing::box_shape({0.2, 0.2, 0.2});
  scene.add(cube, testing::at({0, 0, 0.09}), LevelChoice::automatic);
  scene.read();
  EXPECT_NEAR(scene.sample.max_other_penetration_m, 0.01, 1e-9);
  scene.add(cube, testing::at({-0.97, 5, 1}), LevelChoice::automatic);
  scene.read();
  EXPECT_NEAR(scene.sample.max_other_penetration_m, 0.07, 1e-9);
  EXPECT_EQ(scene.sample.max_tables_penetration_m, 0.0);
}

// A body that comes from `tables` may be as deep as its sphere was, until it has been awake for a while.
TEST(RunSample, WhoComesFromTablesSinksOutOfHisSphereFirst) {
  Sampled scene;
  scene.add(testing::box_shape({0.2, 0.2, 0.2}), testing::at({0, 0, 0.09}), LevelChoice::automatic);
  scene.sample.awake_since_tables = {0};
  for (int i = 1; i < kSinking; ++i) {
    scene.read();
    ASSERT_EQ(scene.sample.awake_since_tables[0], i);
    EXPECT_NEAR(scene.sample.max_tables_penetration_m, 0.01, 1e-9);
    EXPECT_EQ(scene.sample.max_other_penetration_m, 0.0);
  }
  scene.read();
  EXPECT_NEAR(scene.sample.max_other_penetration_m, 0.01, 1e-9);
  EXPECT_EQ(scene.sample.max_tables_penetration_m, 0.0);
}

TEST(RunSample, OnlyFullBodiesInThePictureCount) {
  RunSample sample;
  sample.states = {testing::at({10, 0, 0}), testing::at({10, 1, 0}), testing::at({-10, 0, 0})};
  sample.rungs = {Rung::full, Rung::support, Rung::full};
  const Camera camera(Vec3::Zero(), Vec3(1, 0, 0));
  EXPECT_EQ(count_full_in_picture(sample, camera), 1);
  sample.rungs[1] = Rung::full;
  EXPECT_EQ(count_full_in_picture(sample, camera), 2);
}

}  // namespace
}  // namespace lodestone
