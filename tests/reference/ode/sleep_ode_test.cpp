#include <gtest/gtest.h>
#include <ode/ode.h>

#include <vector>

#include "reference/ode/body_joints.h"
#include "reference/ode/ode_world.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct Bed {
  explicit Bed(const SleepLaw& law, bool on = true) : world({.auto_disable = on, .sleep = law}, materials) {
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
  }
  double time_to_sleep(OdeBodyId body, double most = 4.0) {
    double t = 0.0;
    for (; t < most && !world.asleep(body); t += 1.0 / 60) world.step(1.0 / 60, 4);
    return t;
  }
  MaterialTable materials = material(0.0, 0.5);
  OdeWorld world;
};

// A box that lies sleeps after the law's time, however long that is.
TEST(OdeSleep, ComesAfterTheLawsTime) {
  for (const double time : {0.1, 0.5, 1.5}) {
    Bed bed({.time = time});
    const OdeBodyId box = bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1})});
    EXPECT_NEAR(bed.time_to_sleep(box), time, 0.1) << time;
  }
}

TEST(OdeSleep, IsAQuestionOfSpeed) {
  for (const double speed : {0.02, 0.2}) {
    // It glides on at .1 m/s, without friction.
    const MaterialTable materials = material(0.0, 0.0);
    OdeWorld world({.auto_disable = true, .sleep = {.speed = speed, .turning_speed = speed}}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const OdeBodyId box =
        world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1}, {0.1, 0, 0})});
    for (int i = 0; i < 90; ++i) world.step(1.0 / 60, 4);
    EXPECT_EQ(world.asleep(box), speed > 0.1) << speed;
  }
}

// Woken by ODE's own step, by one that comes to lie on it, it fell for a substep, since sleepers had no
// contacts.
TEST(OdeSleep, WhoIsWokenStandsOnWhatBoreHim) {
  Bed bed({});
  const auto box = box_shape({0.2, 0.2, 0.2});
  std::vector<OdeBodyId> tower;
  for (int i = 0; i < 3; ++i) {
    tower.push_back(bed.world.add_body({.shape = box, .state = at({0, 0, 0.0999 + 0.1999 * i})}));
    bed.world.set_asleep(tower.back(), true);
  }
  bed.world.add_body({.shape = box, .state = at({0, 0, 0.0999 + 0.1999 * 3}, {0, 0, -1e-3})});
  bed.world.step(1.0 / 240);
  for (const OdeBodyId body : tower) {
    EXPECT_FALSE(bed.world.asleep(body));
    EXPECT_NEAR(bed.world.state(body).velocity.z(), 0.01, 0.015);  // parted from its overlap
  }
}

// Nor had they where what woke them was a joint. A substep that is repeated lays them down first: a beam from
// which a load swung sank into its pillars.
TEST(OdeSleep, WhoIsWokenByAJointStandsOnWhatBoreHim) {
  Bed bed({});
  const auto box = box_shape({0.2, 0.2, 0.2});
  const OdeBodyId standing = bed.world.add_body({.shape = box, .mass = 8.0, .state = at({0, 0, 0.0999})}),
                  hanging = bed.world.add_body({.shape = box, .mass = 1.0, .state = at({0, 1, 0.5})});
  join_bodies(bed.world.ode_body(standing), bed.world.ode_body(hanging), JointKind::ball, {0, 0, 0.1});
  bed.world.set_asleep(standing, true);
  bed.world.step(1.0 / 240);
  EXPECT_FALSE(bed.world.asleep(standing));
  EXPECT_GT(bed.world.contacts().size(), 3u);
  EXPECT_GT(bed.world.state(standing).velocity.z(), -1e-3);
}

// Enabled as its contact was made, a crate under a press was not known to have slept.
TEST(OdeSleep, WhoIsWokenByAPressStandsOnWhatBoreHim) {
  double speed[2] = {};
  for (const bool sleeps : {false, true}) {
    Bed bed({});
    const OdeBodyId crate =
        bed.world.add_body({.shape = box_shape({0.4, 0.4, 0.4}), .mass = 64.0, .state = at({0, 0, 0.2})});
    for (int i = 0; i < 60; ++i) bed.world.step(1.0 / 60, 4);
    ASSERT_TRUE(bed.world.asleep(crate));
    bed.world.set_asleep(crate, sleeps);
    bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}),
                        .mass = 8.0,
                        .state = at({0.05, 0, 0.5 - 1e-3}, {0, 0, -0.5}),
                        .properties = {.kinematic = true}});
    bed.world.step(1.0 / 240);
    EXPECT_FALSE(bed.world.asleep(crate));
    speed[sleeps] = bed.world.state(crate).velocity.z();
  }
  EXPECT_NEAR(speed[true], speed[false], 0.02);
}

// Woken one by one, they were laid down again in each step, since what one was given was lost in the others.
TEST(OdeSleep, WhatHangsTogetherFallsWhenItsPillarIsRemoved) {
  Bed bed({});
  const OdeBodyId pillar =
      bed.world.add_body({.shape = box_shape({0.28, 0.28, 1.5}), .mass = 100.0, .state = at({0, 0, 0.75})});
  std::vector<OdeBodyId> chain;
  for (int i = 0; i < 6; ++i)
    chain.push_back(bed.world.add_body(
        {.shape = box_shape({0.3, 0.3, 0.3}), .mass = 27.0, .state = at({0, 0, 1.65 + 0.35 * i})}));
  for (int i = 0; i < 5; ++i)  // three points hold as a fixed joint does
    for (const Vec3& at : {Vec3(0.1, 0, 0), Vec3(-0.1, 0.1, 0), Vec3(-0.1, -0.1, 0)})
      join_bodies(bed.world.ode_body(chain[std::size_t(i)]), bed.world.ode_body(chain[std::size_t(i) + 1]),
                  JointKind::ball, at + Vec3(0, 0, 1.825 + 0.35 * i));
  for (int i = 0; i < 120; ++i) bed.world.step(1.0 / 60, 4);
  ASSERT_TRUE(bed.world.asleep(chain[0]));
  const double before = bed.world.state(chain[0]).position.z();
  bed.world.remove_body(pillar);
  for (int i = 0; i < 30; ++i) bed.world.step(1.0 / 60, 4);
  EXPECT_NEAR(before - bed.world.state(chain[0]).position.z(), 0.5 * kGravity * 0.25, 0.03);
}

TEST(OdeSleep, WhatHoldsASleeperUpActsInTheStepThatWakesIt) {
  Bed bed({});
  const auto box = box_shape({0.2, 0.2, 0.2});
  const OdeBodyId held = bed.world.add_body({.shape = box, .mass = 2.0, .state = at({0, 0, 1})}),
                  other = bed.world.add_body({.shape = box, .mass = 2.0, .state = at({5, 0, 1})});
  bed.world.hold(held, {0, 0, 2.0 * kGravity}, Vec3::Zero());
  bed.world.set_asleep(held, true);
  for (int i = 0; i < 30; ++i) bed.world.step(1.0 / 60, 4);
  ASSERT_TRUE(bed.world.asleep(held));
  bed.world.set_state(other, at({0.1999, 0, 1}));
  bed.world.add_force(other, {0, 0, 2.0 * kGravity}, Vec3::Zero());
  bed.world.step(1.0 / 60, 4);
  EXPECT_FALSE(bed.world.asleep(held));
  EXPECT_NEAR(bed.world.state(held).velocity.z(), 0.0, 0.01);
}

// In the air, at the top of its flight, nobody sleeps: nothing holds it.
TEST(OdeSleep, NobodySleepsThatNothingHolds) {
  Bed bed({.speed = 100.0, .turning_speed = 100.0, .time = 0.05});
  const OdeBodyId body = bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 20})});
  for (int i = 0; i < 60; ++i) {
    bed.world.step(1.0 / 60);
    EXPECT_FALSE(bed.world.asleep(body));
  }
}

TEST(OdeSleep, MayBeForbiddenOrOff) {
  Bed off({}, false), on({});
  const auto box = box_shape({0.2, 0.2, 0.2});
  const OdeBodyId never = off.world.add_body({.shape = box, .state = at({0, 0, 0.1})}),
                  restless = on.world.add_body(
                      {.shape = box, .state = at({0, 0, 0.1}), .properties = {.allow_sleep = false}}),
                  other = on.world.add_body({.shape = box, .state = at({2, 0, 0.1})});
  EXPECT_GE(off.time_to_sleep(never, 2.0), 2.0);
  EXPECT_LT(on.time_to_sleep(other, 2.0), 1.0);
  EXPECT_FALSE(on.world.asleep(restless));
}

TEST(OdeSleep, LawMayChangeOnTheWay) {
  Bed bed({.time = 100.0});
  const OdeBodyId box = bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1})});
  EXPECT_GE(bed.time_to_sleep(box, 1.0), 1.0);
  bed.world.set_sleep_law({.time = 0.1});
  bed.world.set_asleep(box, true);
  bed.world.set_asleep(box, false);  // its time begins anew
  EXPECT_LT(bed.time_to_sleep(box), 0.3);
}

// Whoever wakes it, through ODE itself too: its time begins anew.
TEST(OdeSleep, WokenItTakesItsTimeAgain) {
  Bed bed({.time = 0.5});
  const OdeBodyId box = bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1})});
  bed.time_to_sleep(box);
  ASSERT_TRUE(bed.world.asleep(box));
  dBodyEnable(bed.world.ode_body(box));
  EXPECT_NEAR(bed.time_to_sleep(box), 0.5, 0.05);
  bed.world.set_asleep(box, false);
  EXPECT_NEAR(bed.time_to_sleep(box), 0.5, 0.05);
}

// A plank that is drawn away under a load asleep, each at what friction lets it have; together they keep what
// momentum they are given.
TEST(OdeSleep, ALoadGoesWithWhatIsDrawnAwayUnderIt) {
  for (const double pull : {1.0, 4.0}) {  // m/s²: less than friction holds
    for (const int substeps : {1, 4, 16}) {
      Bed bed({});
      const OdeBodyId plank = bed.world.add_body(
                          {.shape = box_shape({4, 1, 0.1}), .mass = 20.0, .state = at({0, 0, 0.05})}),
                      load = bed.world.add_body(
                          {.shape = box_shape({0.3, 0.3, 0.3}), .mass = 5.0, .state = at({0, 0, 0.25})});
      bed.time_to_sleep(load);
      ASSERT_TRUE(bed.world.asleep(load) && bed.world.asleep(plank));
      bed.world.set_asleep(plank, false);
      for (int i = 0; i < 60; ++i) {
        bed.world.add_force(plank, {25.0 * (pull + 0.5 * 9.81), 0, 0}, Vec3::Zero());
        bed.world.step(1.0 / 60, substeps);
      }
      EXPECT_NEAR(bed.world.state(plank).velocity.x(), pull, 0.03 * pull) << substeps;
      EXPECT_NEAR(bed.world.state(load).velocity.x(), pull, 0.03 * pull) << substeps;
    }
  }
}

// Put to rest in each substep, who lay still took all that friction gave it, and its carrier stopped.
TEST(OdeSleep, WhoLiesOnOneThatIsGivenASlowPushGoesAlong) {
  for (const double speed : {0.06, 0.1, 0.18})  // m/s, below four times the law's
    for (const int substeps : {1, 4, 16}) {
      MaterialTable materials = material(0.0, 0.5);
      const MaterialId ice = materials.add({.restitution = 0.0, .friction = 0.5});
      materials.set_law(0, ice, {.restitution = 0.0, .friction = 0.0});
      OdeWorld world({.auto_disable = true}, materials);
      world.add_plane(Vec3::UnitZ(), 0.0, ice);
      const OdeBodyId cart = world.add_body(
                          {.shape = box_shape({2, 2, 0.2}), .mass = 200, .state = at({0, 0, 0.1})}),
                      crate = world.add_body(
                          {.shape = box_shape({0.3, 0.3, 0.3}), .mass = 10, .state = at({0, 0, 0.35})});
      for (int i = 0; i < 120; ++i) world.step(1.0 / 60, substeps);
      ASSERT_TRUE(world.asleep(cart) && world.asleep(crate));
      RigidState pushed = world.state(cart);
      pushed.velocity.x() = speed;
      world.set_asleep(cart, false);
      world.set_state(cart, pushed);
      for (int i = 0; i < 180; ++i) world.step(1.0 / 60, substeps);
      const double together = 3.0 * speed * 200 / 210;  // m, in three seconds
      EXPECT_NEAR(world.state(cart).position.x(), together, 0.08 * together) << speed << ' ' << substeps;
      EXPECT_NEAR(world.state(crate).position.x(), world.state(cart).position.x(), 0.01)
          << speed << ' ' << substeps;
    }
}

// A platform on a joint to a kinematic body carries however slowly this goes.
TEST(OdeSleep, WhoLiesOnWhatHangsOnAMovingBodyGoesAlong) {
  for (const double speed : {0.02, 0.1, 0.19}) {
    Bed bed({});
    const OdeBodyId mover = bed.world.add_body({.shape = box_shape({0.3, 0.3, 0.3}),
                                                .mass = 10,
                                                .state = at({-1, 0, 2}),
                                                .properties = {.kinematic = true}}),
                    plate = bed.world.add_body(
                        {.shape = box_shape({1, 1, 0.1}), .mass = 10, .state = at({0, 0, 2})}),
                    crate = bed.world.add_body(
                        {.shape = box_shape({0.3, 0.3, 0.3}), .mass = 20, .state = at({0, 0, 2.2})});
    const dJointID joint = dJointCreateFixed(dBodyGetWorld(bed.world.ode_body(plate)), nullptr);
    dJointAttach(joint, bed.world.ode_body(plate), bed.world.ode_body(mover));
    dJointSetFixed(joint);
    for (int i = 0; i < 120; ++i) bed.world.step(1.0 / 60, 4);
    RigidState moved = bed.world.state(mover);
    moved.velocity.y() = speed;
    bed.world.set_state(mover, moved);
    for (int i = 0; i < 240; ++i) bed.world.step(1.0 / 60, 4);
    EXPECT_NEAR(bed.world.state(plate).position.y(), 4.0 * speed, 1e-3);
    EXPECT_NEAR(bed.world.state(crate).position.y(), 4.0 * speed, 5e-3) << speed;
  }
}

// At rest it is at rest: no speed is left that a wake would bring back.
TEST(OdeSleep, PutsAnEndToAllMotion) {
  Bed bed({.speed = 0.5, .turning_speed = 0.5, .time = 0.05});
  const OdeBodyId box =
      bed.world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1}, {0.3, 0, 0})});
  bed.time_to_sleep(box);
  ASSERT_TRUE(bed.world.asleep(box));
  EXPECT_EQ(bed.world.state(box).velocity, Vec3(Vec3::Zero()));
  EXPECT_EQ(bed.world.state(box).angular_velocity, Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace lodestone
