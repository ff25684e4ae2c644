// Ground that comes while bodies sleep.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <utility>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCube = 0.3, kRisen = 0.1;  // m

enum class NewGround { plane, box, mesh, their_plane, their_box, their_plane_moved };

class GroundThatComes : public ::testing::TestWithParam<NewGround> {
 protected:
  GroundThatComes() { dWorldSetGravity(world_, 0, 0, -9.81); }
  ~GroundThatComes() override {
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  void come(Manager& manager) {
    switch (GetParam()) {
      case NewGround::plane:
        manager.add_plane(Vec3::UnitZ(), kRisen);
        break;
      case NewGround::box:
        manager.add_static_box({4, 4, 2 * kRisen}, Vec3::Zero(), Quat::Identity());
        break;
      case NewGround::mesh:
        manager.add_static_mesh(
            {.vertices = {{-3, -3, kRisen}, {3, -3, kRisen}, {3, 3, kRisen}, {-3, 3, kRisen}},
             .faces = {{0, 1, 2}, {0, 2, 3}}});
        break;
      case NewGround::their_plane:
        their_ = dCreatePlane(space_, 0, 0, 1, kRisen);
        break;
      case NewGround::their_box:
        their_ = dCreateBox(space_, 4, 4, 2 * kRisen);
        break;
      case NewGround::their_plane_moved:
        dGeomPlaneSetParams(floor_, 0, 0, 1, kRisen);
        break;
    }
  }
  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dHashSpaceCreate(nullptr);
  dGeomID floor_ = dCreatePlane(space_, 0, 0, 1, 0), their_ = nullptr;
};

TEST_P(GroundThatComes, RaisesWhoSleepsInIt) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    dGeomPlaneSetParams(floor_, 0, 0, 1, 0);
    Manager manager(world_, space_, {.signatures = coarse_signature});
    const BodyId sunk = add(manager, box_shape({kCube, kCube, kCube}), testing::at({0, 0, kCube / 2}), level),
                 above =
                     add(manager, box_shape({kCube, kCube, kCube}), testing::at({0, 0, 1.5 * kCube}), level);
    run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(sunk)) << int(level);
    come(manager);
    run(manager, 4.0);
    EXPECT_NEAR(manager.state(sunk).position.z(), kRisen + kCube / 2, 0.01 * kCube) << int(level);
    EXPECT_NEAR(manager.state(above).position.z(), kRisen + 1.5 * kCube, 0.1 * kCube) << int(level);
    EXPECT_TRUE(manager.asleep(sunk)) << int(level);
    if (their_) dGeomDestroy(std::exchange(their_, nullptr));
  }
}

INSTANTIATE_TEST_SUITE_P(All, GroundThatComes,
                         ::testing::Values(NewGround::plane, NewGround::box, NewGround::mesh,
                                           NewGround::their_plane, NewGround::their_box,
                                           NewGround::their_plane_moved));

// By less than the lowest falls in a few steps: those above hung in the air, asleep.
TEST(ManagerGround, WhatStandsOnGroundThatSinksALittleComesDown) {
  constexpr double kSide = 0.4;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const double down : {0.003, 0.03}) {
      Manager manager({.signatures = coarse_signature});
      const GroundId shelf = manager.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity());
      std::vector<BodyId> stack;
      for (int i = 0; i < 3; ++i)
        stack.push_back(
            add(manager, box_shape({kSide, kSide, kSide}), testing::at({0, 0, (i + 0.5) * kSide}), level));
      run(manager, 3.0);
      std::vector<double> before;
      for (const BodyId body : stack) {
        ASSERT_TRUE(manager.asleep(body)) << int(level);
        before.push_back(manager.state(body).position.z());
      }
      manager.move_ground(shelf, testing::at({0, 0, -0.5 - down}));
      run(manager, 5.0);
      for (std::size_t i = 0; i < stack.size(); ++i)
        EXPECT_NEAR(manager.state(stack[i]).position.z(), before[i] - down, 2e-3)
            << int(level) << ", " << down << " m, " << i;
    }
}

// Longer than a body may be: `support` stood on it, and who became full was lost with the step.
TEST(ManagerGround, AFloorOfManyKilometresHoldsOnEachRung) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_box({20'000, 30'000, 2}, {0, 0, -1}, Quat::Identity());
    const BodyId body =
        testing::add(manager, testing::box_shape({0.4, 0.4, 0.4}), testing::at({70, 30, 0.3}), level);
    testing::run(manager, 2.0);
    EXPECT_NEAR(manager.state(body).position.z(), 0.2, 0.01) << int(level);
    EXPECT_TRUE(manager.asleep(body)) << int(level);
  }
}

}  // namespace
}  // namespace lodestone
