// What joints bring onto a full body, statistical bodies under it bear.
#include "lod/manager/joint_contacts.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::joint_contacts_test {
namespace {

using namespace testing;

constexpr double kCrate = 0.3, kLimb = 0.1, kTorso = 0.2;  // m
constexpr double kLimbMass = 1.0, kTorsoMass = 50.0;       // kg
constexpr double kBears = 0.005;  // m: without the joint's load the limb goes through the crate
const Vec3 kLimbAt(0.02, 0, kCrate + kLimb / 2 + 0.001),
    kTorsoAt(0.02, 0, kCrate + kLimb + kTorso / 2 + 0.003), kBetween = 0.5 * (kLimbAt + kTorsoAt);

const ManagerSettings kSettings{.signatures = coarse_signature};

struct TheirWorld {
  TheirWorld() { dWorldSetGravity(world, 0, 0, -9.81); }
  ~TheirWorld() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  dBodyID add_box(double side, double mass, const Vec3& at) {
    const dBodyID body = dBodyCreate(world);
    dMass m;
    dMassSetBoxTotal(&m, mass, side, side, side);
    dBodySetMass(body, &m);
    dBodySetPosition(body, at.x(), at.y(), at.z());
    dGeomSetBody(dCreateBox(space, side, side, side), body);
    return body;
  }
  void join(const std::string& kind, dBodyID first, dBodyID second) const {
    dJointID joint = nullptr;
    if (kind == "hinge") joint = dJointCreateHinge(world, nullptr);
    if (kind == "fixed") joint = dJointCreateFixed(world, nullptr);
    if (kind == "slider") joint = dJointCreateSlider(world, nullptr);
    dJointAttach(joint, first, second);
    if (kind == "hinge") {
      dJointSetHingeAnchor(joint, kBetween.x(), kBetween.y(), kBetween.z());
      dJointSetHingeAxis(joint, 0, 0, 1);
    }
    if (kind == "fixed") dJointSetFixed(joint);
    if (kind == "slider") dJointSetSliderAxis(joint, 1, 0, 0);
  }
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dGeomID floor = dCreatePlane(space, 0, 0, 1, 0);
};

BodyId add_crate(Manager& manager, LevelChoice level) {
  return manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                           .state = testing::at({0, 0, kCrate / 2}),
                           .mass = 5.0,
                           .level = level});
}

BodyId add_full(Manager& manager, double side, double mass, const Vec3& at) {
  return manager.add_body({.shape = box_shape({side, side, side}),
                           .state = testing::at(at),
                           .mass = mass,
                           .level = LevelChoice::full});
}

TEST(JointContacts, ACrateBearsWhatIsJointedToALimb) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const char* kind : {"hinge", "fixed", "slider"}) {
      TheirWorld theirs;
      Manager manager(theirs.world, theirs.space, kSettings);
      const BodyId crate = add_crate(manager, level), limb = add_full(manager, kLimb, kLimbMass, kLimbAt),
                   torso = add_full(manager, kTorso, kTorsoMass, kTorsoAt);
      manager.step(kFrame);
      theirs.join(kind, manager.ode_body(limb), manager.ode_body(torso));
      double deepest = 0.0;
      for (int i = 0; i < 240; ++i) {
        manager.step(kFrame);
        deepest = std::max(deepest, manager.state(crate).position.z() + kCrate / 2 -
                                        (manager.state(limb).position.z() - kLimb / 2));
      }
      EXPECT_LT(deepest, kBears) << int(level) << ", " << kind;
      for (const BodyId body : {crate, limb, torso})
        EXPECT_TRUE(manager.asleep(body)) << int(level) << ", " << kind;
    }
}

TEST(JointContacts, SoItDoesForBodiesOfTheCallers) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    const BodyId crate = add_crate(manager, level);
    const dBodyID limb = theirs.add_box(kLimb, kLimbMass, kLimbAt),
                  torso = theirs.add_box(kTorso, kTorsoMass, kTorsoAt);
    theirs.join("fixed", limb, torso);
    double deepest = 0.0;
    for (int i = 0; i < 240; ++i) {
      manager.step(kFrame);
      deepest = std::max(
          deepest, manager.state(crate).position.z() + kCrate / 2 - (dBodyGetPosition(limb)[2] - kLimb / 2));
    }
    EXPECT_LT(deepest, 2 * kBears) << int(level);
  }
}

// Who sleeps moves no more: what overlaps of theirs have grown is undone by moving their bodies.
// Two bodies on a joint do not meet: where they are bent into each other nothing of that is felt.
TEST(JointContacts, LimbsBentIntoEachOtherLieStill) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    add(manager, box_shape({1.2, 1.2, 0.3}), testing::at({0, 0, 0.15}), level);
    const Vec3 joint(0, 0, 0.361);
    const auto limb = box_shape({0.3, 0.12, 0.12});
    std::vector<BodyId> limbs;
    for (const double turn : {0.3, 1.5}) {
      const Quat way(Eigen::AngleAxisd(turn, Vec3::UnitZ()));
      limbs.push_back(add(manager, limb, {.position = joint + way * Vec3(0.17, 0, 0), .orientation = way},
                          LevelChoice::full));
    }
    const dJointID ball = dJointCreateBall(theirs.world, nullptr);
    dJointAttach(ball, manager.ode_body(limbs[0]), manager.ode_body(limbs[1]));
    dJointSetBallAnchor(ball, joint.x(), joint.y(), joint.z());
    for (const BodyId body : limbs) manager.add_impulse(body, {0, 0, 3}, manager.state(body).position);
    run(manager, 3.0);
    double fastest = 0.0;
    for (int i = 0; i < 120; ++i) {
      manager.step(kFrame);
      for (const BodyId body : limbs)
        fastest = std::max(fastest, manager.state(body).angular_velocity.norm());
    }
    EXPECT_LT(fastest, 0.02) << int(level);  // rad/s
    for (const BodyId body : limbs) EXPECT_TRUE(manager.asleep(body)) << int(level);
  }
}

TEST(JointContacts, TheirsDoNotSinkIntoSleepers) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    std::vector<BodyId> crates;
    for (const double x : {-0.33, 0.0, 0.33})
      crates.push_back(
          add(manager, box_shape({kCrate, kCrate, kCrate}), testing::at({x, 0, kCrate / 2}), level));
    run(manager, 2.0);
    const dBodyID light = theirs.add_box(kLimb, 2.0, {-0.17, 0, kCrate + 0.07}),
                  heavy = theirs.add_box(kLimb, 20.0, {0.17, 0, kCrate + 0.07});
    const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
    dJointAttach(hinge, light, heavy);
    dJointSetHingeAnchor(hinge, 0, 0, kCrate + 0.07);
    dJointSetHingeAxis(hinge, 0, 1, 0);
    run(manager, 20.0);
    for (const BodyId crate : crates) EXPECT_TRUE(manager.asleep(crate)) << int(level);
    for (const dBodyID body : {light, heavy})
      EXPECT_NEAR(dBodyGetPosition(body)[2], kCrate + kLimb / 2, 0.002) << int(level);
  }
}

// A slider of `body` with a motor; `reversed`: as the second body of its joint, which turns it round.
void drive(TheirWorld& theirs, dBodyID body, const Vec3& along, double speed, double force,
           bool reversed = false) {
  const dJointID slider = dJointCreateSlider(theirs.world, nullptr);
  dJointAttach(slider, reversed ? nullptr : body, reversed ? body : nullptr);
  dJointSetSliderAxis(slider, along.x(), along.y(), along.z());
  dJointSetSliderParam(slider, dParamVel, reversed ? -speed : speed);
  dJointSetSliderParam(slider, dParamFMax, force);
}

TEST(JointContacts, AMotorDoesNotPressAPlateThroughACrate) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double force : {50.0, 500.0, 10000.0}) {  // N
      TheirWorld theirs;
      Manager manager(theirs.world, theirs.space, kSettings);
      const BodyId crate = add_crate(manager, level);
      const dBodyID plate = theirs.add_box(kTorso, 10.0, {0, 0, kCrate + 0.15});
      drive(theirs, plate, Vec3::UnitZ(), -0.2, force);
      run(manager, 5.0);
      EXPECT_NEAR(dBodyGetPosition(plate)[2], kCrate + kTorso / 2, 0.002)
          << int(level) << ", " << force << " N";
      EXPECT_TRUE(manager.asleep(crate)) << int(level) << ", " << force << " N";
    }
}

TEST(JointContacts, AMotorPushesARowOfSleepers) {
  constexpr int kRow = 4;
  constexpr double kTorsoToCrate = (kTorso + kCrate) / 2, kWay = 0.6;
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double speed : {0.05, 0.3})  // m/s: also what is too slow to wake a sleeper
      for (const bool reversed : {false, true}) {
        TheirWorld theirs;
        Manager manager(theirs.world, theirs.space, kSettings);
        std::vector<BodyId> row;
        for (int i = 0; i < kRow; ++i)
          row.push_back(manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                                          .state = testing::at({0.31 * i, 0, kCrate / 2}),
                                          .mass = 5.0,
                                          .level = level}));
        run(manager, 2.0);
        const dBodyID ram = theirs.add_box(kTorso, 20.0, {-kTorsoToCrate - 0.01, 0, kTorso / 2});
        drive(theirs, ram, Vec3::UnitX(), speed, 1000.0, reversed);
        run(manager, kWay / speed);
        const auto told = [&] {
          return ::testing::Message() << int(level) << ", " << speed << " m/s, " << reversed;
        };
        EXPECT_NEAR(dBodyGetPosition(ram)[0], -kTorsoToCrate - 0.01 + kWay, 0.02) << told();
        EXPECT_NEAR(manager.state(row.front()).position.x(), kWay - 0.01, 0.02) << told();
      }
}

TEST(JointContacts, ALiftOnAMotorCarriesAStack) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double speed : {0.05, 0.5}) {
      TheirWorld theirs;
      Manager manager(theirs.world, theirs.space, kSettings);
      const dBodyID lift = theirs.add_box(1.0, 20.0, {0, 0, 1.0});
      drive(theirs, lift, Vec3::UnitZ(), 0.0, 5000.0);
      std::vector<BodyId> stack;
      for (int i = 0; i < 3; ++i)
        stack.push_back(manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                                          .state = testing::at({0.01 * i, 0, 1.5 + kCrate * (i + 0.5)}),
                                          .mass = 5.0,
                                          .level = level}));
      run(manager, 2.0);
      EXPECT_NEAR(dBodyGetPosition(lift)[2], 1.0, 0.01) << int(level);
      dJointSetSliderParam(dBodyGetJoint(lift, 0), dParamVel, speed);
      dBodyEnable(lift);
      run(manager, 1.0 / speed);
      EXPECT_NEAR(dBodyGetPosition(lift)[2], 2.0, 0.02) << int(level) << ", " << speed << " m/s";
      for (std::size_t i = 0; i < stack.size(); ++i)
        EXPECT_NEAR(manager.state(stack[i]).position.z() - dBodyGetPosition(lift)[2],
                    0.5 + kCrate * (double(i) + 0.5), 0.02)
            << int(level) << ", " << speed << " m/s";
    }
}

/// Holds a body in its place and its attitude, by motors of 3 kN along three axes and about them.
dJointID hold_by_motors(const TheirWorld& theirs, dBodyID body) {
  const dJointID turning = dJointCreateAMotor(theirs.world, nullptr),
                 linear = dJointCreateLMotor(theirs.world, nullptr);
  for (const dJointID joint : {turning, linear}) dJointAttach(joint, body, nullptr);
  dJointSetAMotorNumAxes(turning, 3), dJointSetLMotorNumAxes(linear, 3);
  for (int axis = 0; axis < 3; ++axis) {
    dJointSetAMotorAxis(turning, axis, 0, axis == 0, axis == 1, axis == 2);
    dJointSetLMotorAxis(linear, axis, 0, axis == 0, axis == 1, axis == 2);
    dJointSetAMotorParam(turning, dParamFMax + axis * dParamGroup2, 3000.0);
    dJointSetLMotorParam(linear, dParamFMax + axis * dParamGroup2, 3000.0);
  }
  return linear;
}

// What such motors held was taken for a force of the caller's, which lags: the lift fell under what fell onto
// it, by up to .8 m.
TEST(JointContacts, ALiftOnAnLMotorBearsWhatFallsOntoIt) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    const dBodyID lift = theirs.add_box(0.6, 29.0, {0, 0, 1.0});
    const dJointID motor = hold_by_motors(theirs, lift);
    std::vector<BodyId> stack;
    for (int i = 0; i < 2; ++i)
      stack.push_back(manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                                        .state = testing::at({0.05, 0, 1.35 + kCrate * (i + 0.5)}),
                                        .mass = 12.0,
                                        .level = level}));
    run(manager, 3.0);
    EXPECT_NEAR(dBodyGetPosition(lift)[2], 1.0, 0.01) << int(level);
    dJointSetLMotorParam(motor, dParamVel3, 0.1);
    run(manager, 3.0);
    EXPECT_NEAR(dBodyGetPosition(lift)[2], 1.3, 0.02) << int(level);
    for (std::size_t i = 0; i < stack.size(); ++i)
      EXPECT_NEAR(manager.state(stack[i]).position.z() - dBodyGetPosition(lift)[2],
                  0.3 + kCrate * (double(i) + 0.5), 0.02)
          << int(level);
  }
}

// Of 1.5 m, full, 2 m up; it has its ODE body.
BodyId add_plate(Manager& manager) {
  const BodyId plate = manager.add_body({.shape = box_shape({1.5, 1.5, 0.1}),
                                         .state = testing::at({0, 0, 2}),
                                         .mass = 50.0,
                                         .level = LevelChoice::full});
  manager.step(1e-9);
  return plate;
}

// A stop acted a step late: crates sank into a lift that stood at one, and those of `tables` fell through it.
// Those of joints whose first body is a kinematic one of his were not known.
enum class Lift { hangs, driven, driven_by_his };
TEST(JointContacts, ALiftAtItsStopBearsCrates) {
  for (const Lift lift : {Lift::hangs, Lift::driven, Lift::driven_by_his})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      const bool is_driven = lift != Lift::hangs;
      TheirWorld their;
      Manager manager(their.world, their.space, kSettings);
      const BodyId plate = add_plate(manager);
      const dBodyID body = manager.ode_body(plate);
      const dJointID slider = dJointCreateSlider(their.world, nullptr);
      if (lift == Lift::driven_by_his) {
        const dBodyID post = dBodyCreate(their.world);
        dBodySetKinematic(post);
        dJointAttach(slider, post, body);
        dJointSetSliderAxis(slider, 0, 0, -1);
      } else {
        dJointAttach(slider, body, nullptr);
        dJointSetSliderAxis(slider, 0, 0, 1);
      }
      if (is_driven) {  // and rides up to it
        dJointSetSliderParam(slider, dParamVel, 0.5);
        dJointSetSliderParam(slider, dParamFMax, 5e3);
        dJointSetSliderParam(slider, dParamHiStop, 0.5);
      } else {
        dJointSetSliderParam(slider, dParamLoStop, 0.0);
      }
      std::vector<BodyId> crates;
      for (int i = 0; i < 4; ++i)
        crates.push_back(add(manager, box_shape({kCrate, kCrate, kCrate}),
                             testing::at({0.4 * (i % 2) - 0.2, 0.4 * (i / 2) - 0.2, 2.05 + 0.5 * kCrate}),
                             level));
      run(manager, 6.0);
      EXPECT_NEAR(manager.state(plate).position.z(), is_driven ? 2.5 : 2.0, 2e-3);
      for (const BodyId crate : crates)
        EXPECT_NEAR(manager.state(crate).position.z() - manager.state(plate).position.z(),
                    0.05 + 0.5 * kCrate, 3e-3)
            << int(lift) << ' ' << int(level);
    }
}

// Whichever body of its hinge it is, made where it stands up by an angle.
TEST(JointContacts, OnATrapdoorAtItsStopCratesComeToRest) {
  constexpr double kOpen = 0.8;  // rad
  for (const bool is_first : {true, false})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      TheirWorld their;
      Manager manager(their.world, their.space, kSettings);
      const BodyId door = add_plate(manager);
      const Vec3 anchor(-0.75, 0, 2);
      const RigidState closed = manager.state(door);
      const Quat up(Eigen::AngleAxisd(-kOpen, Vec3::UnitY()));
      manager.set_state(door, {.position = anchor + up * (closed.position - anchor), .orientation = up});
      const dBodyID body = manager.ode_body(door);
      const dJointID hinge = dJointCreateHinge(their.world, nullptr);
      dJointAttach(hinge, is_first ? body : nullptr, is_first ? nullptr : body);
      dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(hinge, 0, 1, 0);  // down is ahead
      dJointSetHingeParam(hinge, dParamHiStop, kOpen);
      manager.set_state(door, closed);
      std::vector<BodyId> crates;
      for (const double x : {-0.2, 0.4})
        crates.push_back(add(manager, box_shape({kCrate, kCrate, kCrate}),
                             testing::at({x, 0, 2.05 + 0.5 * kCrate}), level));
      run(manager, 6.0);
      for (const BodyId crate : crates) {
        EXPECT_NEAR(manager.state(crate).position.z(), 2.05 + 0.5 * kCrate, 3e-3) << int(level) << is_first;
        EXPECT_TRUE(manager.asleep(crate)) << int(level) << is_first;
      }
    }
}

TEST(JointContacts, ADoorOnAMotorSweepsCratesAside) {
  const auto mean_of = [](LevelChoice level) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    std::vector<BodyId> crates;
    for (int i = 0; i < 3; ++i)
      crates.push_back(add(manager, box_shape({kCrate, kCrate, kCrate}),
                           testing::at({0.5 + 0.31 * i, 0.3, kCrate / 2}), level));
    run(manager, 1.0);
    const dBodyID door = dBodyCreate(theirs.world);
    dMass mass;
    dMassSetBoxTotal(&mass, 20.0, 1.6, 0.05, 0.6);
    dBodySetMass(door, &mass);
    dBodySetPosition(door, 0.85, 0, 0.35);
    dGeomSetBody(dCreateBox(theirs.space, 1.6, 0.05, 0.6), door);
    const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
    dJointAttach(hinge, door, nullptr);
    dJointSetHingeAnchor(hinge, 0, 0, 0.35);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    dJointSetHingeParam(hinge, dParamVel, 0.5);
    dJointSetHingeParam(hinge, dParamFMax, 2000.0);
    run(manager, 2.0);
    EXPECT_NEAR(dJointGetHingeAngle(hinge), 1.0, 0.02) << int(level);
    Vec3 mean = Vec3::Zero();
    for (const BodyId crate : crates) mean += manager.state(crate).position / double(crates.size());
    return mean;
  };
  const Vec3 full = mean_of(LevelChoice::full);
  EXPECT_LT((mean_of(LevelChoice::support) - full).norm(), 0.08);
  EXPECT_LT((mean_of(LevelChoice::tables) - full).norm(), 0.3);
}

// A plank with one end on a hinge of the world, at the height of the crate on which its other end lies.
BodyId add_hinged_plank(const TheirWorld& theirs, Manager& manager, double mass) {
  const BodyId plank = manager.add_body({.shape = box_shape({1.0, 0.2, 0.1}),
                                         .state = testing::at({0.4, 0, kCrate + 0.051}),
                                         .mass = mass,
                                         .level = LevelChoice::full});
  manager.step(kFrame);
  const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
  dJointAttach(hinge, manager.ode_body(plank), nullptr);
  dJointSetHingeAnchor(hinge, 0.9, 0, kCrate + 0.05);
  dJointSetHingeAxis(hinge, 0, 1, 0);
  return plank;
}

TEST(JointContacts, TheWorldBearsItsShare) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    const BodyId crate = add_crate(manager, level), plank = add_hinged_plank(theirs, manager, 20.0);
    run(manager, 4.0);
    EXPECT_NEAR(manager.state(plank).position.z(), kCrate + 0.05, kBears) << int(level);
    EXPECT_LT(manager.state(crate).position.head<2>().norm(), 0.01) << int(level);
    EXPECT_TRUE(manager.asleep(plank)) << int(level);
  }
}

// A ball of 60 kg on a hinge 3.2 m above it, let go aslant before a wall of bricks. What the hinge's rows had
// given was looked for by place, which changes as the ball swings, and each row's got to another: bricks at
// 10⁵ m/s.
TEST(JointContacts, AWreckingBallOnAHingeThrowsNobody) {
  constexpr double kLever = 3.2, kHigh = 4.0, kAside = -0.45;  // m
  const auto brick = box_shape({0.4, 0.2, 0.2});
  const auto signature = coarse_signature(*brick, {});
  const ManagerSettings settings{.signatures = [&](const Shape&, const ContactLaw&) { return signature; }};
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double angle : {0.958, 1.0, 1.042, 1.208, 1.25, 1.292}) {
      TheirWorld theirs;
      Manager manager(theirs.world, theirs.space, settings);
      manager.materials().replace(0, {.restitution = 0.2, .friction = 0.5});
      std::vector<BodyId> bricks;
      for (int row = 0; row < 6; ++row)
        for (int i = 0; i < 6; ++i)
          bricks.push_back(
              manager.add_body({.shape = brick,
                                .state = testing::at({0.402 * (i - 3) + 0.2 * (row % 2), 0, 0.1 + 0.2 * row}),
                                .mass = 8.0,
                                .level = level}));
      run(manager, 1.0);
      const BodyId ball = manager.add_body(
          {.shape = std::make_shared<const Shape>(make_sphere_shape(0.3)),
           .state = testing::at({0, -kLever * std::sin(angle) + kAside, kHigh - kLever * std::cos(angle)}),
           .mass = 60.0,
           .level = LevelChoice::full});
      const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
      dJointAttach(hinge, manager.ode_body(ball), nullptr);
      dJointSetHingeAnchor(hinge, 0, kAside, kHigh);
      dJointSetHingeAxis(hinge, 1, 0, 0);
      double fastest = 0.0;
      for (int i = 0; i < 200; ++i) {
        manager.step(kFrame);
        for (const BodyId body : bricks) fastest = std::max(fastest, manager.state(body).velocity.norm());
      }
      EXPECT_GT(fastest, 1.0) << int(level) << ' ' << angle;
      EXPECT_LT(fastest, 12.0) << int(level) << ' ' << angle;
    }
}

// What its rows bear goes on being known while other joints of it come and go.
TEST(JointContacts, APlankOnAHingeLiesStillWhileOtherJointsComeAndGo) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    const BodyId crate = add_crate(manager, level),
                 light = add_full(manager, kLimb, kLimbMass, {0.4, 0, kCrate + 0.2}),
                 plank = add_hinged_plank(theirs, manager, 200.0);
    dJointID ball = nullptr;
    double fastest = 0.0;
    for (int i = 0; i < 180; ++i) {
      if (i % 20 == 0) {
        ball = dJointCreateBall(theirs.world, nullptr);
        dJointAttach(ball, manager.ode_body(plank), manager.ode_body(light));
        dJointSetBallAnchor(ball, 0.4, 0, kCrate + 0.12);
      } else if (i % 20 == 10) {
        dJointDestroy(ball);
      }
      manager.step(kFrame);
      if (i > 60) fastest = std::max(fastest, manager.state(crate).velocity.norm());
    }
    EXPECT_LT(fastest, 0.05) << int(level);
    EXPECT_NEAR(manager.state(plank).position.z(), kCrate + 0.05, 2 * kBears) << int(level);
  }
}

// Ten planks hinged to each other and to the world, a little slack: ODE keeps all five crates on them.
// Thirteen of fifteen were thrown off.
TEST(JointContacts, ABridgeOfHingedPlanksCarriesCrates) {
  constexpr int kPlanks = 10;
  constexpr double kApart = 0.42, kSlack = 0.03;  // m, rad
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld theirs;
    Manager manager(theirs.world, theirs.space, kSettings);
    manager.materials().replace(0, {.restitution = 0.3, .friction = 0.6});
    Vec3 end(-0.5 * kApart * kPlanks, 0, 3);
    dBodyID before = nullptr;
    const auto hinge_to = [&](dBodyID body) {
      const dJointID hinge = dJointCreateHinge(theirs.world, nullptr);
      dJointAttach(hinge, body ? body : before, body ? before : nullptr);
      dJointSetHingeAnchor(hinge, end.x(), 0, end.z());
      dJointSetHingeAxis(hinge, 0, 1, 0);
      before = body;
    };
    for (int i = 0; i < kPlanks; ++i) {
      const Quat turn(Eigen::AngleAxisd(i < kPlanks / 2 ? kSlack : -kSlack, Vec3::UnitY()));
      const BodyId plank =
          manager.add_body({.shape = box_shape({0.4, 1.0, 0.06}),
                            .state = {.position = end + turn * Vec3(0.5 * kApart, 0, 0), .orientation = turn},
                            .mass = 10.0,
                            .level = LevelChoice::full});
      hinge_to(manager.ode_body(plank));
      end += turn * Vec3(kApart, 0, 0);
    }
    hinge_to(nullptr);
    run(manager, 2.0);
    std::vector<BodyId> crates;
    for (int i = 0; i < 5; ++i) {
      crates.push_back(add_crate(manager, level));
      manager.set_state(crates.back(), testing::at({-1.2 + 0.6 * i, 0.02 * (i - 2), 3.2 + 0.35 * i}));
    }
    run(manager, 8.0);
    for (const BodyId crate : crates) {
      EXPECT_GT(manager.state(crate).position.z(), 2.8) << int(level);
      EXPECT_LT(manager.state(crate).velocity.norm(), 0.5) << int(level);
    }
  }
}

// Of a hinge-2 joint whose bodies are attached: sprung upwards, turning about y, not steered.
void set_up_axle(dJointID axle, const Vec3& hub, double suspension_erp, double suspension_cfm) {
  const dVector3 up = {0, 0, 1}, across = {0, 1, 0};
  dJointSetHinge2Anchor(axle, hub.x(), hub.y(), hub.z());
  dJointSetHinge2Axes(axle, up, across);
  dJointSetHinge2Param(axle, dParamLoStop, 0), dJointSetHinge2Param(axle, dParamHiStop, 0);
  dJointSetHinge2Param(axle, dParamSuspensionERP, suspension_erp);
  dJointSetHinge2Param(axle, dParamSuspensionCFM, suspension_cfm);
}

// On wheels with springs and motors, over a slab that is a body: it went at 1.3 m/s instead of 1.5, and at .8
// when it had coasted for five seconds.
TEST(JointContacts, ASprungCarRollsOverABody) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    constexpr double kWheel = 0.25, kSlab = 0.2, kSpeed = 1.5;  // m, m/s
    TheirWorld his;
    Manager manager(his.world, his.space, kSettings);
    manager.materials().replace(0, {.restitution = 0.1, .friction = 0.6});
    const auto slab = box_shape({40, 4, kSlab});
    manager.add_body({.shape = slab, .state = at({18, 0, kSlab / 2}), .mass = 8000.0, .level = level});
    const auto make_body = [&](const Vec3& place, const dMass& mass, dGeomID geom) {
      const dBodyID body = dBodyCreate(his.world);
      dBodySetMass(body, &mass);
      dBodySetPosition(body, place.x(), place.y(), place.z());
      dGeomSetBody(geom, body);
      return body;
    };
    dMass mass;
    dMassSetBoxTotal(&mass, 200.0, 1.6, 0.8, 0.3);
    const dBodyID chassis = make_body({0, 0, 0.65}, mass, dCreateBox(his.space, 1.6, 0.8, 0.3));
    dMassSetSphereTotal(&mass, 12.0, kWheel);
    std::vector<dJointID> axles;
    for (const double x : {0.6, -0.6})
      for (const double y : {0.55, -0.55}) {
        const Vec3 hub(x, y, kSlab + kWheel);
        const dJointID axle = axles.emplace_back(dJointCreateHinge2(his.world, nullptr));
        dJointAttach(axle, chassis, make_body(hub, mass, dCreateSphere(his.space, kWheel)));
        set_up_axle(axle, hub, 0.05, 6e-4);
        dJointSetHinge2Param(axle, dParamVel2, -kSpeed / kWheel);
      }
    const auto drive = [&](double torque, double seconds) {
      for (const dJointID axle : axles) dJointSetHinge2Param(axle, dParamFMax2, torque);
      run(manager, seconds);
      return double(dBodyGetLinearVel(chassis)[0]);
    };
    const double driven = drive(200.0, 3.0), coasting = drive(0.0, 4.0);
    EXPECT_NEAR(driven, kSpeed, 0.03) << int(level);
    EXPECT_NEAR(coasting, driven, 0.03) << int(level);
  }
}

// On springs that hardly give within a frame it was taken to yield as far as its force of the last substep
// was less than the load: crates of `tables` went down through it.
TEST(JointContacts, OnAParkedTruckCratesLie) {
  TheirWorld their;
  ManagerSettings settings = kSettings;
  settings.full_substeps = 16;  // as many as a bed with walls takes by itself
  Manager manager(their.world, their.space, settings);
  const MaterialId rubber = manager.materials().add({.restitution = 0.0, .friction = 0.9});
  manager.add_plane(Vec3::UnitZ(), 0.0, rubber);
  const auto add_part = [&](const std::shared_ptr<const Shape>& shape, const Vec3& place, double mass) {
    return manager.add_body(
        {.shape = shape, .state = at(place), .material = rubber, .mass = mass, .level = LevelChoice::full});
  };
  const BodyId bed = add_part(box_shape({3, 1.6, 0.2}), {0, 0, 0.7}, 1200.0);
  for (const double x : {1.1, -1.1})
    for (const double y : {0.95, -0.95}) {
      const Vec3 hub(x, y, 0.4);
      const BodyId wheel = add_part(sphere_shape(0.35), hub, 30.0);
      manager.step(1e-9);
      const dJointID axle = dJointCreateHinge2(their.world, nullptr);
      dJointAttach(axle, manager.ode_body(bed), manager.ode_body(wheel));
      set_up_axle(axle, hub, 0.4, 2e-5);
    }
  run(manager, 1.0);
  std::vector<BodyId> crates;
  for (int i = 0; i < 8; ++i)
    crates.push_back(manager.add_body(
        {.shape = box_shape({0.4, 0.4, 0.4}),
         .state = at(manager.state(bed).position + Vec3(0.6 * (i % 4) - 0.9, 0.6 * (i / 4) - 0.3, 0.32)),
         .material = rubber,
         .mass = 64.0,
         .level = LevelChoice::tables}));
  run(manager, 5.0);
  for (const BodyId crate : crates)
    EXPECT_NEAR(manager.state(crate).position.z() - manager.state(bed).position.z(), 0.3, 0.005);
}

// Asleep it did not feel what was laid on it without a fall.
TEST(JointContacts, APlateAsleepOnASpringSagsUnderWhatIsLaidOnIt) {
  constexpr double kStiffness = 20e3, kDamping = 4e3, kMass = 50.0, kLoad = 200.0;  // N/m, N s/m, kg
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    TheirWorld their;
    Manager manager(their.world, their.space, kSettings);
    const BodyId plate = add_plate(manager);
    const dJointID slider = dJointCreateSlider(their.world, nullptr);
    dJointAttach(slider, manager.ode_body(plate), nullptr);
    dJointSetSliderAxis(slider, 0, 0, 1);
    const double h = kFrame / 4.0;
    dJointSetSliderParam(slider, dParamLoStop, 0), dJointSetSliderParam(slider, dParamHiStop, 0);
    dJointSetSliderParam(slider, dParamStopERP, h * kStiffness / (h * kStiffness + kDamping));
    dJointSetSliderParam(slider, dParamStopCFM, 1.0 / (h * kStiffness + kDamping));
    run(manager, 4.0);
    ASSERT_TRUE(manager.asleep(plate)) << int(level);
    const double stood = manager.state(plate).position.z();
    EXPECT_NEAR(stood, 2.0 - kMass * 9.81 / kStiffness, 1e-3);
    for (int i = 0; i < 4; ++i)
      manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                        .state = at({0.8 * (i % 2) - 0.4, 0.8 * (i / 2) - 0.4, stood + 0.05 + 0.5 * kCrate}),
                        .mass = kLoad / 4.0,
                        .level = level});
    run(manager, 4.0);
    EXPECT_NEAR(manager.state(plate).position.z(), stood - kLoad * 9.81 / kStiffness, 5e-3) << int(level);
  }
}

// The rows are those of the platform, however far away the kinematic body is, and whichever comes first.
TEST(JointContacts, OnAPlatformFixedToAFarKinematicBodyCratesLie) {
  for (const bool platform_first : {true, false})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      TheirWorld their;
      Manager manager(their.world, their.space, kSettings);
      const BodyId plate = add_plate(manager);
      const dBodyID post = their.add_box(0.3, 1.0, {-3, 0, 2}), body = manager.ode_body(plate);
      dBodySetKinematic(post);
      const dJointID joint = dJointCreateFixed(their.world, nullptr);
      dJointAttach(joint, platform_first ? body : post, platform_first ? post : body);
      dJointSetFixed(joint);
      std::vector<BodyId> crates;
      for (int i = 0; i < 2; ++i)
        crates.push_back(add(manager, box_shape({kCrate, kCrate, kCrate}),
                             testing::at({0.1, 0, 2.05 + (i + 0.5) * kCrate}), level));
      run(manager, 4.0);
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(manager.state(crates[i]).position.z(), 2.05 + (i + 0.5) * kCrate, 6e-3)
            << platform_first << int(level);
        EXPECT_LT(manager.state(crates[i]).velocity.norm(), 0.01) << platform_first << int(level);
      }
    }
}

// A post of 3 kg, fixed to the world, bears what its other joint brings onto it, as the world does.
TEST(JointContacts, OnABoardThatASmallPostHoldsCratesLie) {
  for (const bool slides : {false, true})
    for (const bool board_first : {true, false})
      for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
        TheirWorld their;
        Manager manager(their.world, their.space, kSettings);
        const auto add_full = [&](const Vec3& sides, double mass, const Vec3& at) {
          return manager.ode_body([&] {
            const BodyId body = manager.add_body({.shape = box_shape(sides),
                                                  .state = testing::at(at),
                                                  .mass = mass,
                                                  .level = LevelChoice::full});
            manager.step(1e-9);
            return body;
          }());
        };
        const dBodyID post = add_full({0.1, 0.1, 0.1}, 3.0, {-1.5, 0, 2}),
                      board = add_full({1, 1, 0.1}, 10.0, {0.5, 0, 2});
        const dJointID anchor = dJointCreateFixed(their.world, nullptr);
        dJointAttach(anchor, post, nullptr);
        dJointSetFixed(anchor);
        const dJointID joint =
            slides ? dJointCreateSlider(their.world, nullptr) : dJointCreateFixed(their.world, nullptr);
        dJointAttach(joint, board_first ? board : post, board_first ? post : board);
        if (slides) {
          dJointSetSliderAxis(joint, 0, 0, 1);
          dJointSetSliderParam(joint, dParamLoStop, 0), dJointSetSliderParam(joint, dParamHiStop, 0);
        } else {
          dJointSetFixed(joint);
        }
        std::vector<BodyId> crates;
        for (int i = 0; i < 2; ++i)
          crates.push_back(manager.add_body({.shape = box_shape({kCrate, kCrate, kCrate}),
                                             .state = testing::at({0.7, 0.2, 2.05 + (i + 0.5) * kCrate}),
                                             .mass = 20.0,
                                             .level = level}));
        run(manager, 3.0);
        for (int i = 0; i < 2; ++i) {
          const RigidState crate = manager.state(crates[i]);
          EXPECT_NEAR(crate.position.z(), 2.05 + (i + 0.5) * kCrate, 6e-3)
              << slides << board_first << int(level);
          EXPECT_LT(crate.velocity.norm(), 0.02) << slides << board_first << int(level);
        }
      }
}

TEST(JointContacts, APistonsMotorLiftsAndItsStopsHoldWhatLiesOnThePlatform) {
  for (const bool is_driven : {true, false})
    for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
      TheirWorld their;
      Manager manager(their.world, their.space, kSettings);
      const BodyId plate = add_plate(manager);
      const dJointID piston = dJointCreatePiston(their.world, nullptr);
      dJointAttach(piston, manager.ode_body(plate), nullptr);
      dJointSetPistonAxis(piston, 0, 0, 1);
      const Vec3 at = manager.state(plate).position;
      dJointSetPistonAnchor(piston, at.x(), at.y(), at.z());
      if (is_driven) {
        dJointSetPistonParam(piston, dParamVel, 0.3);
        dJointSetPistonParam(piston, dParamFMax, 5e3);
      } else {
        dJointSetPistonParam(piston, dParamLoStop, 0.0);
        dJointSetPistonParam(piston, dParamHiStop, 0.0);
      }
      const BodyId crate = add(manager, box_shape({kCrate, kCrate, kCrate}),
                               testing::at({at.x(), 0, 2.05 + 0.5 * kCrate}), level);
      run(manager, 2.0);
      EXPECT_NEAR(manager.state(plate).position.z(), is_driven ? 2.6 : 2.0, 5e-3) << int(level);
      EXPECT_NEAR(manager.state(crate).position.z() - manager.state(plate).position.z(), 0.05 + 0.5 * kCrate,
                  4e-3)
          << int(level);
    }
}

}  // namespace
}  // namespace lodestone::joint_contacts_test
