#include "reference/ode/timed_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::timed_contacts_test {
namespace {

using namespace testing;

constexpr double kStep = 1.0 / 240.0, kFall = kGravity * kStep;

TimedStep falling_at(double speed, const Vec3& spin = Vec3::Zero()) {
  return {.body = at({0, 0, 0.1}, {0, 0, -speed}, spin), .duration = kStep, .restitution = 0.5};
}

/// m, in `time` seconds: ODE's `speed` is that of the middle of the last step.
double way(double speed, double time) { return (speed + 0.5 * kFall) * time + 0.5 * kGravity * time * time; }

struct Answer {
  std::optional<TimedImpact> impact;
  std::vector<ContactPoint> contacts;
};

Answer answer(const std::vector<NearPoint>& near, const TimedStep& step) {
  Answer found;
  found.impact = append_timed_contacts(near, step, found.contacts);
  return found;
}

TEST(TimedContacts, AVertexStrikesWhenItGetsThere) {
  const Answer found = answer({{{0, 0, -0.1}, -0.25 * kStep}}, falling_at(1.0));
  ASSERT_EQ(found.contacts.size(), 1U);
  EXPECT_NEAR(way(1.0, found.impact.value().time), 0.25 * kStep, 1e-12);
  EXPECT_EQ(found.impact->fall, Vec3(0, 0, -kFall));
  EXPECT_EQ(found.contacts[0].depth, 0.0);
}

TEST(TimedContacts, AVertexInsideStruckBeforeTheStepButNotLongBefore) {
  const auto time_at = [](double depth) {
    return answer({{{0, 0, -0.1}, depth}}, falling_at(1.0)).impact.value().time;
  };
  EXPECT_NEAR(way(1.0, time_at(0.25 * kStep)), -0.25 * kStep, 1e-12);
  EXPECT_EQ(time_at(0.01), -kStep);
  EXPECT_EQ(time_at(1.0), -kStep);  // from where no fall would have brought it
}

TEST(TimedContacts, LaterVerticesWait) {
  const Answer apart =
      answer({{{0, 0, -0.1}, -0.25 * kStep}, {{0.1, 0, -0.1}, -0.5 * kStep}}, falling_at(1.0));
  ASSERT_EQ(apart.contacts.size(), 1U);
  EXPECT_NEAR(apart.contacts[0].point.x(), 0.0, 1e-12);
  EXPECT_EQ(answer({{{0, 0, -0.1}, -0.25 * kStep}, {{0.1, 0, -0.1}, -0.26 * kStep}}, falling_at(1.0))
                .contacts.size(),
            2U);
}

TEST(TimedContacts, TheContactIsWhereTheVertexStrikes) {
  const Vec3 spin(0, 0, 20);
  const Answer found = answer({{{0.1, 0, -0.1}, -0.5 * kStep}}, falling_at(1.0, spin));
  ASSERT_EQ(found.contacts.size(), 1U);
  EXPECT_NEAR(std::atan2(found.contacts[0].point.y(), found.contacts[0].point.x()),
              20 * found.impact.value().time, 1e-9);
}

TEST(TimedContacts, WhatRestsIsHeldAndWhatLeavesIsNot) {
  const double gap = 0.1 * kFall * kStep;
  const Answer resting = answer({{{0, 0, -0.1}, -gap}}, falling_at(0.0));
  ASSERT_EQ(resting.contacts.size(), 1U);
  EXPECT_FALSE(resting.impact);
  EXPECT_NEAR(resting.contacts[0].lift, -gap / kStep, 1e-12);
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -gap}}, falling_at(-1.1 * kFall)).contacts.empty());
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -1.1 * kFall * kStep}}, falling_at(0.0)).contacts.empty());
}

TEST(TimedContacts, SlowLandingsAreOdesOwn) {
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -1e-5}}, falling_at(kFall)).contacts.empty());
  const Answer landed = answer({{{0, 0, -0.1}, 1e-4}}, falling_at(kFall));
  ASSERT_EQ(landed.contacts.size(), 1U);
  EXPECT_FALSE(landed.impact);
  EXPECT_EQ(landed.contacts[0].depth, 1e-4);
  EXPECT_EQ(landed.contacts[0].lift, 0.0);
}

TEST(TimedContacts, ALateImpulseMovesTheBodyForTheRestOfTheStepOnly) {
  const RigidState start = at({0, 0, 1}, {0, 0, -2}), kicked = at({0, 0, 1 + kStep}, {0, 0, 1}, {3, 0, 0},
                                                                  rotation_from_vector({3 * kStep, 0, 0}));
  const RigidState end = end_of_step(start, kicked, {.time = 0.25 * kStep});
  EXPECT_NEAR(end.position.z(), 1 - 2 * 0.25 * kStep + 0.75 * kStep, 1e-12);
  EXPECT_NEAR(2 * std::atan2(end.orientation.x(), end.orientation.w()), 3 * 0.75 * kStep, 1e-9);
  EXPECT_EQ(end.velocity, kicked.velocity);
}

TEST(TimedContacts, WhatIsNotContactsDoingIsNotLate) {
  const RigidState start = at({0, 0, 1}, {0, 0, -2}), end = at({0, 0, 1 - 2.1 * kStep}, {0, 0, -2.1});
  EXPECT_EQ(end_of_step(start, end, {.time = 0.5 * kStep, .fall = end.velocity - start.velocity}).position,
            end.position);
}

// Turned back across its axis a rod has more energy: in the body's axes it is to turn as the solver had it.
TEST(TimedContacts, TurningBackKeepsTheSpinInTheBodysAxes) {
  const RigidState start = at({0, 0, 1}, {0, 0, -2}, {0, 20, 0}),
                   struck = at({0, 0, 1}, {0, 0, 1}, {30, -10, 200}, turned_on(start, 0.9 * kStep));
  RigidState stepped = struck;
  stepped.orientation = turned_on(struck, kStep);
  const RigidState end = end_of_step(start, stepped, {.time = 0.9 * kStep});
  EXPECT_LT(end.orientation.angularDistance(turned_on(struck, 0.1 * kStep)), 1e-9);
  EXPECT_LT((end.orientation.conjugate() * end.angular_velocity -
             struck.orientation.conjugate() * struck.angular_velocity)
                .norm(),
            1e-9);
}

// Its lowest point, turned with it, made a torque of each bounce: the spin 40 rad/s became 69.
TEST(TimedContacts, ABallThatBouncesWithoutFrictionKeepsItsSpin) {
  const MaterialTable table = material(0.8, 0.0);
  OdeWorld world({.gravity = Vec3::Zero(), .timed_contacts_above = 7e-4}, table);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId ball =
      world.add_body({.shape = sphere_shape(0.1), .state = at({0, 0, 0.51}, {0, 0, -5}, {0, 40, 0})});
  for (int i = 0; i < 20; ++i) world.step(1.0 / 60.0, 4);
  EXPECT_NEAR(world.state(ball).velocity.z(), 4.0, 1e-5);
  EXPECT_LT((world.state(ball).angular_velocity - Vec3(0, 40, 0)).norm(), 1e-5);
}

// Gained 2 % a bounce, and half as much again in a minute.
TEST(TimedContacts, WhatBouncesFullyRisesAsHighAMinuteLater) {
  const MaterialTable table = material(1.0, 0.0);
  for (const auto& shape : {sphere_shape(0.1), box_shape(Vec3::Constant(0.2))}) {
    OdeWorld world({.timed_contacts_above = 7e-4}, table);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const OdeBodyId body = world.add_body({.shape = shape, .state = at({0, 0, 2.1})});
    double highest = 0.0;
    for (int i = 0; i < 3600; ++i) {
      world.step(1.0 / 60.0, 4);
      if (i > 3000) highest = std::max(highest, world.state(body).position.z());
    }
    EXPECT_NEAR(highest, 2.1, 0.02) << shape->name;
  }
}

// Of these 32 without friction 25 gained, up to 1e10-fold.
TEST(TimedContacts, ThinRodsGainNoEnergy) {
  const auto rod = box_shape({0.04, 0.04, 0.8});
  const MaterialTable table = material(0.9, 0.0);
  for (std::uint32_t k = 0; k < 32; ++k) {
    RandomStream random(1, k, 0);
    OdeWorld world({.timed_contacts_above = 7e-4}, table);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const Quat turned = random.orientation();
    const RigidState start = at({0, 0, 1.5}, Vec3::Zero(), 17.0 * random.direction(), turned);
    const OdeBodyId body = world.add_body({.shape = rod, .state = start});
    double most = 0.0;
    for (int i = 0; i < 600; ++i) {
      world.step(1.0 / 60.0, 4);
      most = std::max(most, energy_of(*rod, 1.0, world.state(body)));
    }
    EXPECT_LT(most, 1.02 * energy_of(*rod, 1.0, start)) << k;
  }
}

}  // namespace
}  // namespace lodestone::timed_contacts_test
