// Ground of an OdeWorld: laid, moved, removed, and what cannot be.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "reference/error.h"
#include "tests/message_of.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kOdd = std::numeric_limits<double>::quiet_NaN();

struct OdeScene {
  MaterialTable materials = material(0.0, 0.5);
  OdeWorld world{{.auto_disable = true}, materials};
  OdeBodyId box(const Vec3& place) {
    return world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at(place)});
  }
  void run(double seconds) {
    for (int i = 0; i < int(std::lround(seconds * 60)); ++i) world.step(1.0 / 60, 4);
  }
  double height(OdeBodyId body) const { return world.state(body).position.z(); }
};

// A plane, a box and a mesh at the same height hold a box at the same height.
TEST(OdeGroundKinds, HoldAlike) {
  for (int kind = 0; kind < 3; ++kind) {
    OdeScene scene;
    if (kind == 0) scene.world.add_plane(Vec3::UnitZ(), 0.5, 0);
    if (kind == 1) scene.world.add_static_box({4, 4, 1}, {0, 0, 0}, Quat::Identity(), 0);
    if (kind == 2) scene.world.add_static_mesh(make_box({4, 4, 1}), 0);
    const OdeBodyId body = scene.box({0.1, 0.2, 0.62});
    scene.run(1.5);
    EXPECT_NEAR(scene.height(body), 0.6, 1e-3) << kind;
    EXPECT_TRUE(scene.world.asleep(body)) << kind;
  }
}

TEST(OdeGroundKinds, WhatLiesOnItWakesAndFallsOnceItIsRemoved) {
  for (int kind = 0; kind < 3; ++kind) {
    OdeScene scene;
    const OdeGroundId ground = kind == 0 ? scene.world.add_plane(Vec3::UnitZ(), 0.5, 0)
                               : kind == 1
                                   ? scene.world.add_static_box({4, 4, 1}, {0, 0, 0}, Quat::Identity(), 0)
                                   : scene.world.add_static_mesh(make_box({4, 4, 1}), 0);
    const OdeBodyId body = scene.box({0, 0, 0.61});
    scene.run(1.5);
    ASSERT_TRUE(scene.world.asleep(body));
    scene.world.remove_ground(ground);
    EXPECT_FALSE(scene.world.asleep(body)) << kind;
    scene.run(0.5);
    EXPECT_LT(scene.height(body), 0.0) << kind;
    EXPECT_THROW(scene.world.remove_ground(ground), InputError);
  }
}

// Ids are never given twice, though the places are.
TEST(OdeGroundKinds, IdsStayTheirOwn) {
  OdeScene scene;
  const OdeGroundId first = scene.world.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity(), 0);
  scene.world.remove_ground(first);
  const OdeGroundId second = scene.world.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity(), 0);
  EXPECT_FALSE(first == second);
  EXPECT_EQ(message_of([&] {
              scene.world.move_ground(first, at({0, 0, 0}));
            }),
            "OdeGroundId " + std::to_string(first.value) +
                ": found no such box or mesh, expected one of this world");
  EXPECT_NO_THROW(scene.world.move_ground(second, at({0, 0, 1})));
  EXPECT_THROW(scene.world.remove_ground({}), InputError);
}

// A lift carries up what lies on it; without a velocity it still lifts what it is put under.
TEST(OdeGroundKinds, WhatMovesCarries) {
  OdeScene scene;
  const OdeGroundId lift = scene.world.add_static_box({2, 2, 0.2}, {0, 0, 0}, Quat::Identity(), 0);
  const OdeBodyId body = scene.box({0, 0, 0.21});
  scene.run(1.0);
  RigidState state = at({0, 0, 0}, {0.3, 0, 0.5});
  for (int i = 0; i < 60; ++i) {
    state.position += state.velocity / 60;
    scene.world.move_ground(lift, state);
    scene.world.step(1.0 / 60, 4);
  }
  EXPECT_NEAR(scene.height(body), 0.2 + 0.5, 0.02);
  EXPECT_NEAR(scene.world.state(body).position.x(), 0.3, 0.05);
}

// It is where its velocity says in every substep, so that what lies on it neither sinks in nor is thrown.
TEST(OdeGroundKinds, ALiftThatGoesUpAndDownThrowsNothing) {
  constexpr double kGameStep = 1.0 / 60, kAmplitude = 0.12;  // s, m: half of gravity at most
  const auto height = [](int frame) {
    return kAmplitude * (1.0 - std::cos(2.0 * std::numbers::pi * frame * kGameStep));
  };
  for (const int substeps : {4, 16}) {
    OdeScene scene;
    const OdeGroundId lift = scene.world.add_static_box({2, 2, 0.2}, {0, 0, -0.1}, Quat::Identity(), 0);
    const OdeBodyId body = scene.box({0, 0, 0.1});
    for (int i = 0; i < 120; ++i) {
      const double speed = (height(i + 1) - height(i)) / kGameStep;
      scene.world.move_ground(lift, at({0, 0, height(i) - 0.1}, {0, 0, speed}));
      scene.world.step(kGameStep, substeps);
      ASSERT_NEAR(scene.height(body) - height(i + 1), 0.1, 1e-3) << substeps << ", frame " << i;
      ASSERT_LT(scene.world.state(body).angular_velocity.norm(), 0.05) << substeps << ", frame " << i;
    }
  }
}

// An arm strikes what it turns into within a step; that it did not touch where it was put.
TEST(OdeGroundKinds, WhatTurnsDoesSoWithinAStep) {
  constexpr double kGameStep = 1.0 / 60, kTurning = 4.0;  // s, rad/s
  const MaterialTable materials = material(0.0, 0.5);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const OdeGroundId arm = world.add_static_box({4, 0.1, 1}, Vec3::Zero(), Quat::Identity(), 0);
  const OdeBodyId body =
      world.add_body({.shape = box_shape(Vec3::Constant(0.4)), .state = at({1.5, 0.26, 0})});
  world.move_ground(arm, at(Vec3::Zero(), Vec3::Zero(), {0, 0, kTurning}));
  world.step(kGameStep, 16);
  const Quat turned(Eigen::AngleAxisd(kTurning * kGameStep, Vec3::UnitZ()));
  EXPECT_GT((turned.conjugate() * world.state(body).position).y(), 0.24);
}

// Given a velocity once, it begins each step from where it was put.
TEST(OdeGroundKinds, WhatIsNotMovedAgainStaysWhereItWasPut) {
  OdeScene scene;
  const OdeGroundId belt = scene.world.add_static_box({4, 2, 0.2}, {0, 0, -0.1}, Quat::Identity(), 0);
  const OdeBodyId body = scene.box({0, 0, 0.1});
  scene.world.move_ground(belt, at({0, 0, -0.1}, {1.0, 0, 0}));
  for (int i = 0; i < 240 && scene.height(body) > 0.05; ++i) scene.world.step(1.0 / 60, 4);
  EXPECT_NEAR(scene.world.state(body).position.x(), 2.15, 0.1);  // where it fell off
}

TEST(OdeGroundKinds, WhatCannotBeIsRefused) {
  OdeScene scene;
  OdeWorld& world = scene.world;
  EXPECT_EQ(message_of([&] {
              world.add_plane({0, 0, 2}, 0, 0);
            }),
            "a plane: found the normal (0, 0, 2) and the offset 0 m, expected a normal of unit length and a "
            "finite offset");
  EXPECT_THROW(world.add_plane({0, 0, 1}, kOdd, 0), InputError);
  EXPECT_EQ(
      message_of([&] {
        world.add_static_box({1, 0, 1}, {0, 0, 0}, Quat::Identity(), 0);
      }),
      "a static box: found sides of 1, 0 and 1 m and position 0 0 0, orientation 1 0 0 0, velocity 0 0 0, "
      "angular velocity 0 0 0, expected positive sides and a pose that is finite, below 1e8 in each "
      "part, the orientation of unit norm");
  EXPECT_THROW(world.add_static_box({1, 1, 1}, {2e8, 0, 0}, Quat::Identity(), 0), InputError);
  EXPECT_THROW(world.add_static_box({1, 1, 1}, {0, 0, 0}, Quat(2, 0, 0, 0), 0), InputError);
  Mesh mesh = make_box({1, 1, 1});
  mesh.faces.resize(1);
  EXPECT_EQ(message_of([&] { world.add_static_mesh(mesh, 0); }),
            "a trimesh: found 1 faces, expected two or more");
  mesh = make_box({1, 1, 1});
  mesh.faces[0][0] = 99;
  EXPECT_EQ(message_of([&] { world.add_static_mesh(mesh, 0); }),
            "a trimesh: found a face of vertex 99, expected 0 … 7");
  const OdeGroundId box = world.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity(), 0);
  EXPECT_THROW(world.move_ground(box, at({kOdd, 0, 0})), InputError);
  const OdeBodyId body = scene.box({0, 0, 0.61});
  scene.run(1.0);
  EXPECT_NEAR(scene.height(body), 0.6, 1e-3);  // it is where it was
}

// Each ground's own material decides.
TEST(OdeGroundKinds, MaterialsAreTheGrounds) {
  MaterialTable materials = material(0.0, 0.5);
  const MaterialId springy = materials.add({.restitution = 0.8, .friction = 0.5});
  materials.set_law(0, springy, {0.8, 0.5});
  OdeWorld world({}, materials);
  world.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity(), 0);
  world.add_static_box({2, 2, 1}, {5, 0, -0.5}, Quat::Identity(), springy);
  const OdeBodyId dead = world.add_body({.shape = sphere_shape(0.1), .state = at({0, 0, 1.1})}),
                  lively = world.add_body({.shape = sphere_shape(0.1), .state = at({5, 0, 1.1})});
  double highest[2] = {0.0, 0.0};
  for (int i = 0; i < 480; ++i) {
    world.step(1.0 / 480);
    for (const auto& [k, body] : {std::pair(0, dead), std::pair(1, lively)})
      if (i > 230) highest[k] = std::max(highest[k], world.state(body).position.z() - 0.1);
  }
  EXPECT_LT(highest[0], 0.02);
  EXPECT_NEAR(highest[1], 0.64, 0.04);
}

}  // namespace
}  // namespace lodestone
