// What sleeps on something that goes, of a pile of any height, comes down.
#include "lod/manager/left_places.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kSide = 0.3;  // m
constexpr int kTall = 4;
constexpr LevelChoice kRungs[] = {LevelChoice::full, LevelChoice::support, LevelChoice::tables};

std::shared_ptr<const Shape> cube() { return box_shape({kSide, kSide, kSide}); }

ManagerSettings settings() { return {.signatures = coarse_signature}; }

/// Asleep, its lowest crate on z = `floor`.
std::vector<BodyId> sleeping_tower(Manager& manager, LevelChoice level, double floor) {
  std::vector<BodyId> tower;
  for (int i = 0; i < kTall; ++i)
    tower.push_back(add(manager, cube(), testing::at({0, 0, floor + kSide * (i + 0.5) + 1e-4 * i}), level));
  run(manager, 3.0);
  for (const BodyId body : tower) EXPECT_TRUE(manager.asleep(body));
  return tower;
}

/// m, of the highest.
double top_of(const Manager& manager, const std::vector<BodyId>& tower) {
  return manager.state(tower.back()).position.z() + kSide / 2;
}

TEST(LeftPlaces, ATowerComesDownWhereItsLowestCrateIsRemoved) {
  for (const LevelChoice level : kRungs) {
    Manager manager = on_floor(settings());
    const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
    const double before = top_of(manager, tower);
    manager.remove_body(tower.front());
    run(manager, 1.0);
    EXPECT_NEAR(top_of(manager, tower), before - kSide, 0.2 * kSide) << int(level);
  }
}

TEST(LeftPlaces, ATowerComesDownWhereItsLowestCrateIsStruckAway) {
  for (const LevelChoice level : kRungs)
    for (const double speed : {8.0, 25.0}) {  // m/s
      Manager manager = on_floor(settings());
      const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
      const double before = top_of(manager, tower);
      manager.add_impulse(tower.front(), Vec3(speed * manager.mass(tower.front()), 0, 0),
                          manager.state(tower.front()).position);
      run(manager, 1.0);
      EXPECT_LT(top_of(manager, tower), before - 0.4 * kSide) << int(level) << " at " << speed << " m/s";
    }
}

TEST(LeftPlaces, ATowerFallsWhereItsGroundGoes) {
  for (const LevelChoice level : kRungs) {
    Manager manager(settings());
    manager.add_plane(Vec3::UnitZ(), -10.0);
    const GroundId slab = manager.add_static_box({1, 1, 0.2}, {0, 0, -0.1}, Quat::Identity());
    const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
    manager.remove_ground(slab);
    run(manager, 1.0);
    for (const BodyId body : tower) EXPECT_LT(manager.state(body).position.z(), -1.0) << int(level);
  }
}

/// m, between two that lay on each other.
double widest_gap(const Manager& manager, const std::vector<BodyId>& tower) {
  double widest = 0.0;
  for (std::size_t i = 1; i < tower.size(); ++i)
    widest = std::max(
        widest, manager.state(tower[i]).position.z() - manager.state(tower[i - 1]).position.z() - kSide);
  return widest;
}

// As one: it does not wake crate by crate.
TEST(LeftPlaces, ATowerFallsAsItStoodWhereItsGroundIsRemovedOrPutElsewhere) {
  for (const LevelChoice level : kRungs)
    for (const bool is_removed : {true, false}) {
      Manager manager(settings());
      manager.add_plane(Vec3::UnitZ(), -10.0);
      const GroundId slab = manager.add_static_box({1, 1, 0.2}, {0, 0, -0.1}, Quat::Identity());
      const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
      if (is_removed)
        manager.remove_ground(slab);
      else
        manager.move_ground(slab, testing::at({20, 0, -0.1}));
      run(manager, 1.0);
      EXPECT_LT(manager.state(tower.front()).position.z(), -4.0) << int(level) << " removed: " << is_removed;
      EXPECT_LT(widest_gap(manager, tower), 0.1 * kSide) << int(level) << " removed: " << is_removed;
    }
}

/// A caller's, with a floor ten metres down.
struct DeepWorld {
  dWorldID world = nullptr;
  dSpaceID space = nullptr;
  DeepWorld() {
    dInitODE2(0);
    world = dWorldCreate(), space = dHashSpaceCreate(nullptr);
    dWorldSetGravity(world, 0, 0, -9.81);
    dCreatePlane(space, 0, 0, 1, -10.0);
  }
  ~DeepWorld() { dSpaceDestroy(space), dWorldDestroy(world); }
  DeepWorld(const DeepWorld&) = delete;
  DeepWorld& operator=(const DeepWorld&) = delete;
};

TEST(LeftPlaces, ATowerFallsAsItStoodWhereAGeomOfTheCallersGoes) {
  for (const LevelChoice level : kRungs)
    for (const bool is_destroyed : {true, false}) {
      const DeepWorld his_world;
      const dWorldID world = his_world.world;
      const dSpaceID space = his_world.space;
      const dGeomID slab = dCreateBox(space, 1, 1, 0.2);
      dGeomSetPosition(slab, 0, 0, -0.1);
      Manager manager(world, space, settings());
      const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
      if (is_destroyed)
        dGeomDestroy(slab);
      else
        dGeomSetPosition(slab, 50, 0, -0.1);
      run(manager, 1.0);
      EXPECT_LT(manager.state(tower.front()).position.z(), -4.0) << int(level) << " gone: " << is_destroyed;
      EXPECT_LT(widest_gap(manager, tower), 0.1 * kSide) << int(level) << " gone: " << is_destroyed;
    }
}

// One that the caller himself removes, or puts elsewhere.
TEST(LeftPlaces, ATowerFallsWhereABodyOfTheCallersGoes) {
  for (const LevelChoice level : kRungs)
    for (const bool is_destroyed : {true, false}) {
      const DeepWorld his_world;
      const dWorldID world = his_world.world;
      const dSpaceID space = his_world.space;
      const dBodyID his = dBodyCreate(world);
      dMass mass;
      dMassSetBoxTotal(&mass, 500.0, 1, 1, 0.2);
      dBodySetMass(his, &mass);
      dGeomSetBody(dCreateBox(space, 1, 1, 0.2), his);
      dBodySetPosition(his, 0, 0, -0.1);
      const dJointID hold = dJointCreateFixed(world, nullptr);
      dJointAttach(hold, his, nullptr);
      dJointSetFixed(hold);
      dBodySetAutoDisableFlag(his, 1);
      Manager manager(world, space, settings());
      const std::vector<BodyId> tower = sleeping_tower(manager, level, 0.0);
      const double before = top_of(manager, tower);
      dJointDestroy(hold);
      if (is_destroyed)
        dGeomDestroy(dBodyGetFirstGeom(his)), dBodyDestroy(his);
      else
        dBodySetPosition(his, 50, 0, -0.1);
      run(manager, 1.0);
      EXPECT_LT(top_of(manager, tower), before - 1.0) << int(level) << " destroyed: " << is_destroyed;
    }
}

// One that is pushed on never sleeps, and is too slow to wake what fell asleep on it, which hung in the air
// once it had gone.
TEST(LeftPlaces, WhatSleepsOnOneThatCreepsAwayComesDown) {
  constexpr double kSpeed = 0.1;  // m/s
  for (const auto& [below, above] : {std::pair(LevelChoice::support, LevelChoice::support),
                                     std::pair(LevelChoice::tables, LevelChoice::tables),
                                     std::pair(LevelChoice::support, LevelChoice::tables),
                                     std::pair(LevelChoice::tables, LevelChoice::support),
                                     std::pair(LevelChoice::support, LevelChoice::full)}) {
    Manager manager = on_floor(settings());
    const BodyId creeps = add(manager, cube(), testing::at({0, 0, 0.5 * kSide}), below),
                 sleeps = add(manager, cube(), testing::at({0, 0, 1.5 * kSide + 5e-4}), above);
    for (int frame = 0; frame < 30 * 60; ++frame) {
      const RigidState s = manager.state(creeps);
      manager.add_impulse(creeps, manager.mass(creeps) * Vec3(-kSpeed - s.velocity.x(), 0, 0), s.position);
      manager.step(kFrame);
    }
    EXPECT_LT(manager.state(creeps).position.x(), -kSide) << int(below) << " under " << int(above);
    EXPECT_LT(manager.state(sleeps).position.z(), 0.6 * kSide) << int(below) << " under " << int(above);
  }
}

/// A slab of the caller's or, at the full level, of the manager's, 2 m wide, which a motor of his lowers.
struct SlabOnMotor {
  dBodyID body = nullptr;
  dJointID motor = nullptr;
  void hold(dWorldID world, dBodyID slab) {
    body = slab;
    motor = dJointCreateSlider(world, nullptr);
    dJointAttach(motor, slab, nullptr);
    dJointSetSliderAxis(motor, 0, 0, 1);
    dJointSetSliderParam(motor, dParamFMax, 1e5);
  }
  double top() const { return dBodyGetPosition(body)[2] + 0.1; }
};

// However slowly.
TEST(LeftPlaces, WhatSleepsOnASlabThatIsLoweredGoesDownWithIt) {
  for (const LevelChoice level : kRungs)
    for (const bool is_callers : {true, false})
      for (const double speed : {0.02, 0.1, 0.3}) {  // m/s
        const DeepWorld his_world;
        Manager manager(his_world.world, his_world.space, settings());
        SlabOnMotor slab;
        if (is_callers) {
          const dBodyID his = dBodyCreate(his_world.world);
          dMass mass;
          dMassSetBoxTotal(&mass, 500.0, 2, 2, 0.2);
          dBodySetMass(his, &mass);
          dGeomSetBody(dCreateBox(his_world.space, 2, 2, 0.2), his);
          slab.hold(his_world.world, his);
        } else {
          slab.hold(his_world.world, manager.ode_body(add(manager, box_shape({2, 2, 0.2}),
                                                          testing::at({0, 0, 0}), LevelChoice::full)));
        }
        const std::vector<BodyId> tower{
            add(manager, cube(), testing::at({0.2, 0, 0.1 + 0.5 * kSide}), level),
            add(manager, cube(), testing::at({0.2, 0, 0.1 + 1.5 * kSide}), level)};
        run(manager, 4.0);
        dJointSetSliderParam(slab.motor, dParamVel, -speed);
        double gap = 0.0;  // m
        for (int frame = 0; frame < 180; ++frame) {
          manager.step(kFrame);
          gap = std::max(gap, manager.state(tower[0]).position.z() - 0.5 * kSide - slab.top());
        }
        EXPECT_LT(slab.top(), 0.1 - 2.8 * speed);
        EXPECT_LT(gap, 0.1 * kSide + 2.0 * kFrame * speed)
            << int(level) << " at " << speed << " m/s, caller's: " << is_callers;
      }
}

// What moves by a hair wakes nobody, and who stands by himself sleeps on.
TEST(LeftPlaces, WhoStandsFarOffSleepsOn) {
  Manager manager = on_floor(settings());
  const std::vector<BodyId> tower = sleeping_tower(manager, LevelChoice::support, 0.0);
  const BodyId apart = add(manager, cube(), testing::at({3, 0, kSide / 2}), LevelChoice::support);
  run(manager, 2.0);
  manager.remove_body(tower.front());
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    EXPECT_TRUE(manager.asleep(apart));
  }
}

}  // namespace
}  // namespace lodestone
