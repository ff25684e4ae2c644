// A body that slept on a statistical rung and became full where it lay moves, once it is moved, as one that
// was full all along.
#include "lod/manager/eased_bodies.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::eased_bodies_test {
namespace {

using namespace testing;

constexpr LevelChoice kRungs[] = {LevelChoice::full, LevelChoice::support, LevelChoice::tables};

struct Crate {
  explicit Crate(LevelChoice slept) : manager({.signatures = coarse_signature}) {
    manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
    manager.add_plane(Vec3::UnitZ(), -5.0);
    slab = manager.add_static_box({9, 9, 0.2}, {0, 0, -0.1}, Quat::Identity());
    body = add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0, 0, 0.15}), slept);
    run(manager, 2.0);
    manager.set_level(body, LevelChoice::full);
    run(manager, 1.0);
    EXPECT_TRUE(manager.asleep(body));
  }
  Vec3 position() const { return manager.state(body).position; }

  Manager manager;
  GroundId slab;
  BodyId body;
};

TEST(EasedBodies, WhatLosesItsGroundFallsFreely) {
  for (const LevelChoice slept : kRungs) {
    Crate crate(slept);
    const double before = crate.position().z();
    crate.manager.remove_ground(crate.slab);
    run(crate.manager, 0.5);
    EXPECT_NEAR(before - crate.position().z(), 0.5 * 9.81 * 0.25, 0.02) << int(slept);
  }
}

TEST(EasedBodies, AShoveIsNotHeldBack) {
  for (const LevelChoice slept : kRungs) {
    Crate crate(slept);
    const double before = crate.position().x();
    crate.manager.add_impulse(crate.body, Vec3(1.0 * crate.manager.mass(crate.body), 0, 0), crate.position());
    run(crate.manager, 1.0);
    EXPECT_NEAR(crate.position().x() - before, 0.5 / (0.5 * 9.81), 0.01) << int(slept);  // v² / 2 μ g
  }
}

// Ground that begins to move takes it along, though it lay a hair above it.
TEST(EasedBodies, GroundThatMovesTakesItAlong) {
  for (const LevelChoice slept : kRungs) {
    Crate crate(slept);
    const double before = crate.position().x();
    constexpr double kSpeed = 0.5;  // m/s
    for (int i = 1; i <= 60; ++i) {
      RigidState pose = testing::at({kSpeed * kFrame * i, 0, -0.1}, {kSpeed, 0, 0});
      crate.manager.move_ground(crate.slab, pose);
      crate.manager.step(kFrame);
    }
    const double slips = kSpeed * kSpeed / (2.0 * 0.5 * 9.81);  // until it is as fast, v² / 2 μ g
    EXPECT_NEAR(crate.position().x() - before, kSpeed - slips, 0.03) << int(slept);
  }
}

}  // namespace
}  // namespace lodestone::eased_bodies_test
