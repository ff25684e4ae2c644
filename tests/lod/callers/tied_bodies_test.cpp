// Bodies of the caller's without geoms, on joints to full ones; and what he gives those by himself.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::tied_bodies_test {
namespace {

using namespace testing;

constexpr double kGravity = 9.81;                     // m/s²
constexpr double kSledMass = 30.0, kCargoMass = 8.0;  // kg
constexpr std::array kCheapRungs = {LevelChoice::support, LevelChoice::tables};

struct BareWorld {
  BareWorld() {
    dInitODE2(0);
    dWorldSetGravity(world, 0, 0, -kGravity);
  }
  ~BareWorld() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  /// Without a geom.
  dBodyID add_bare(double mass, const Vec3& place) {
    const dBodyID body = dBodyCreate(world);
    dMass parameters;
    dMassSetSphereTotal(&parameters, mass, 0.2);
    dBodySetMass(body, &parameters);
    dBodySetPosition(body, place.x(), place.y(), place.z());
    return body;
  }
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
};

struct FloorWorld : BareWorld {
  FloorWorld() { dCreatePlane(space, 0, 0, 1, 0); }
};

BodyId add_block(Manager& manager, const Vec3& sides, const Vec3& place, double mass, LevelChoice level) {
  return manager.add_body({.shape = box_shape(sides), .state = at(place), .mass = mass, .level = level});
}

/// A full sled with a crate on it.
struct LoadedSled {
  explicit LoadedSled(LevelChoice level)
      : sled(add_block(manager, {1.0, 0.6, 0.1}, {0, 0, 0.05}, kSledMass, LevelChoice::full)),
        crate(add_block(manager, {0.3, 0.3, 0.3}, {0, 0, 0.25}, kCargoMass, level)) {
    run(manager, 0.5);
    apart_before = apart();
  }
  double apart() const { return manager.state(sled).position.x() - manager.state(crate).position.x(); }
  FloorWorld theirs;
  Manager manager{theirs.world, theirs.space, {.signatures = coarse_signature}};
  BodyId sled, crate;
  double apart_before = 0.0;  // m
};

constexpr double kBeyondFriction = 60.0;  // N

double force_to_pull(double mass) { return 0.5 * kGravity * mass + kBeyondFriction; }

TEST(PushedByItsCaller, AFullBodyTakesItsLoadAlong) {
  for (const LevelChoice level : kCheapRungs) {
    LoadedSled loaded(level);
    const double start = loaded.manager.state(loaded.sled).position.x();
    for (int frame = 0; frame < 60; ++frame) {
      dBodyAddForce(loaded.manager.ode_body(loaded.sled), force_to_pull(kSledMass + kCargoMass), 0, 0);
      loaded.manager.step(kFrame);
    }
    EXPECT_NEAR(loaded.manager.state(loaded.sled).position.x() - start,
                0.5 * kBeyondFriction / (kSledMass + kCargoMass), 0.02);
    EXPECT_NEAR(loaded.apart(), loaded.apart_before, 0.005);
  }
}

TEST(TiedBodies, PullALoadedSledAsOnesWithGeomsDo) {
  constexpr double kTug = 2.0;  // kg
  for (const LevelChoice level : kCheapRungs) {
    LoadedSled loaded(level);
    const dBodyID tug = loaded.theirs.add_bare(kTug, {0.6, 0, 0.06});
    const dJointID joint = dJointCreateBall(loaded.theirs.world, nullptr);
    dJointAttach(joint, loaded.manager.ode_body(loaded.sled), tug);
    dJointSetBallAnchor(joint, 0.54, 0, 0.06);
    for (int frame = 0; frame < 60; ++frame) {
      dBodyAddForce(tug, force_to_pull(kSledMass + kCargoMass + kTug), 0, 0);
      loaded.manager.step(kFrame);
    }
    EXPECT_NEAR(loaded.apart(), loaded.apart_before, 0.02);
  }
}

// By a rope of three links, once all have slept: what pulls is joints away from what it moves.
TEST(TiedBodies, ARopePullsWhatHasSlept) {
  constexpr double kLink = 0.2;  // kg
  constexpr int kLinks = 3;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    LoadedSled loaded(level);
    run(loaded.manager, 0.5);
    dBodyID last = loaded.manager.ode_body(loaded.sled);
    for (int i = 0; i < kLinks; ++i) {
      const dBodyID link = loaded.theirs.add_bare(kLink, {0.55 + 0.1 * i, 0, 0.06});
      const dJointID joint = dJointCreateBall(loaded.theirs.world, nullptr);
      dJointAttach(joint, last, link);
      dJointSetBallAnchor(joint, 0.5 + 0.1 * i, 0, 0.06);
      last = link;
    }
    const double mass = kSledMass + kCargoMass + kLinks * kLink,
                 start = loaded.manager.state(loaded.sled).position.x();
    for (int frame = 0; frame < 60; ++frame) {
      dBodyAddForce(last, force_to_pull(mass) * std::min(1.0, frame / 12.0), 0, 0);
      loaded.manager.step(kFrame);
    }
    EXPECT_GT(loaded.manager.state(loaded.sled).position.x() - start, 0.6 * 0.5 * kBeyondFriction / mass)
        << int(level);
    EXPECT_NEAR(loaded.apart(), loaded.apart_before, 0.02) << int(level);
  }
}

// By a kinematic body, which nothing slows down, whichever of the joint's bodies that is.
TEST(TiedBodies, AKinematicTugTakesALoadedSledAlong) {
  constexpr double kSpeed = 0.8;  // m/s
  for (const LevelChoice level : kCheapRungs)
    for (const bool is_first : {false, true}) {
      LoadedSled loaded(level);
      const dBodyID tug = loaded.theirs.add_bare(1.0, {0.6, 0, 0.06}),
                    sled = loaded.manager.ode_body(loaded.sled);
      dBodySetKinematic(tug);
      const dJointID joint = dJointCreateBall(loaded.theirs.world, nullptr);
      dJointAttach(joint, is_first ? tug : sled, is_first ? sled : tug);
      dJointSetBallAnchor(joint, 0.54, 0, 0.06);
      for (int frame = 1; frame <= 120; ++frame) {
        dBodySetLinearVel(tug, kSpeed * std::min(1.0, frame / 60.0), 0, 0);
        loaded.manager.step(kFrame);
      }
      EXPECT_NEAR(loaded.manager.state(loaded.crate).velocity.x(), kSpeed, 0.02) << is_first;
      EXPECT_NEAR(loaded.apart(), loaded.apart_before, 0.01) << is_first;
    }
}

// Whoever is on such a body's joints carries it: what stands below them, too.
TEST(TiedBodies, WeighOnWhatBearsThem) {
  constexpr double kTop = 0.35;  // m, of the middle of the plate where it lies on the crates
  for (const LevelChoice level : kCheapRungs)
    for (const bool is_fixed : {false, true}) {
      FloorWorld theirs;
      Manager manager(theirs.world, theirs.space, {.signatures = coarse_signature});
      for (int i = 0; i < 4; ++i)
        add_block(manager, {0.3, 0.3, 0.3}, {0.6 * (i % 2) - 0.3, 0.6 * (i / 2) - 0.3, 0.15}, 20.0, level);
      const BodyId plate = add_block(manager, {1, 1, 0.1}, {0, 0, kTop + 0.01}, 10.0, LevelChoice::full);
      manager.step(1e-9);  // then ODE has it
      const dBodyID load = theirs.add_bare(500.0, {0, 0, 0.6});
      const dJointID joint =
          is_fixed ? dJointCreateFixed(theirs.world, nullptr) : dJointCreateSlider(theirs.world, nullptr);
      dJointAttach(joint, manager.ode_body(plate), load);
      if (is_fixed)
        dJointSetFixed(joint);
      else
        dJointSetSliderAxis(joint, 1, 0, 0);
      double lowest = kTop, highest = 0.0, fastest = 0.0;
      for (int frame = 0; frame < 180; ++frame) {
        manager.step(kFrame);
        if (frame < 60) continue;
        const RigidState state = manager.state(plate);
        lowest = std::min(lowest, state.position.z()), highest = std::max(highest, state.position.z());
        fastest = std::max(fastest, state.velocity.norm());
      }
      EXPECT_GT(lowest, kTop - 0.004) << is_fixed;
      EXPECT_LT(highest, kTop + 0.004) << is_fixed;
      EXPECT_LT(fastest, 0.2) << is_fixed;
    }
}

// The caller's bodies pass the manager's ground: nothing of it stands behind a board that goes down through
// it.
TEST(TiedBodies, ABoardOfTheCallersPassesTheManagersFloorWithItsLoad) {
  for (const LevelChoice level : kCheapRungs) {
    BareWorld theirs;
    Manager manager(theirs.world, theirs.space, {.signatures = coarse_signature});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const dBodyID board = theirs.add_bare(10.0, {0, 0, 0.6});
    dGeomSetBody(dCreateBox(theirs.space, 3.0, 0.6, 0.1), board);
    dMass mass;
    dMassSetBoxTotal(&mass, 10.0, 3.0, 0.6, 0.1);
    dBodySetMass(board, &mass);
    const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
    dJointAttach(hinge, board, nullptr);
    dJointSetHingeAnchor(hinge, 0, 0, 0.6), dJointSetHingeAxis(hinge, 0, 1, 0);
    add_block(manager, {0.4, 0.4, 0.4}, {1.2, 0, 0.85}, 20.0, level);
    for (int i = 0; i < 30; ++i) {  // its end comes to the floor in the 22nd
      manager.step(1.0 / 60);
      EXPECT_LT(std::abs(dJointGetHingeAngleRate(hinge)), 2.5) << i;
    }
    EXPECT_GT(dJointGetHingeAngle(hinge), 0.5);
  }
}

// Destroyed, let go and given a geom between steps; a snapshot is taken and read in between.
TEST(TiedBodies, MayComeAndGo) {
  LoadedSled loaded(LevelChoice::support);
  std::vector<std::byte> snapshot;
  for (int round = 0; round < 3; ++round) {
    const dBodyID first = loaded.theirs.add_bare(5.0, {0.6, 0, 0.3}),
                  second = loaded.theirs.add_bare(5.0, {0.9, 0, 0.3});
    const dJointID near = dJointCreateBall(loaded.theirs.world, nullptr),
                   far = dJointCreateBall(loaded.theirs.world, nullptr);
    dJointAttach(near, loaded.manager.ode_body(loaded.sled), first);
    dJointSetBallAnchor(near, 0.5, 0, 0.2);
    dJointAttach(far, first, second);
    dJointSetBallAnchor(far, 0.7, 0, 0.3);
    run(loaded.manager, 0.2);
    if (round == 1) dGeomSetBody(dCreateSphere(loaded.theirs.space, 0.05), second);
    run(loaded.manager, 0.2);
    dJointDestroy(far);
    run(loaded.manager, 0.1);
    snapshot = loaded.manager.snapshot();
    loaded.manager.restore(snapshot);
    run(loaded.manager, 0.1);
    if (round == 1) dGeomDestroy(dBodyGetFirstGeom(second));
    dBodyDestroy(second);
    dBodyDestroy(first);  // and with it the joint's hold
    dJointDestroy(near);
    snapshot = loaded.manager.snapshot();
    run(loaded.manager, 0.2);
  }
  EXPECT_TRUE(loaded.manager.state(loaded.crate).position.allFinite());
  EXPECT_NEAR(loaded.manager.state(loaded.crate).position.z(), 0.25, 0.01);
}

}  // namespace
}  // namespace lodestone::tied_bodies_test
