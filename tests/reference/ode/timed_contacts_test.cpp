#include "reference/ode/timed_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::timed_contacts_test {
namespace {

using namespace testing;

constexpr double kStep = 1.0 / 240.0, kFall = kGravity * kStep;

TimedStep falling_at(double speed, const Vec3& spin = Vec3::Zero()) {
  return {.body = at({0, 0, 0.1}, {0, 0, -speed}, spin),
          .gravity = kGravity,
          .duration = kStep,
          .restitution = 0.5};
}

struct Answer {
  std::optional<double> time;
  std::vector<ContactPoint> contacts;
};

Answer answer(const std::vector<NearPoint>& near, const TimedStep& step) {
  Answer found;
  found.time = append_timed_contacts(near, step, found.contacts);
  return found;
}

TEST(TimedContacts, AVertexStrikesWhenItGetsThere) {
  const Answer found = answer({{{0, 0, -0.1}, -0.25 * kStep}}, falling_at(1.0));
  ASSERT_EQ(found.contacts.size(), 1U);
  EXPECT_NEAR(found.time.value(), 0.25 * kStep, 1e-12);
  EXPECT_EQ(found.contacts[0].depth, 0.0);
}

TEST(TimedContacts, AVertexInsideStruckBeforeTheStepButNotLongBefore) {
  EXPECT_NEAR(answer({{{0, 0, -0.1}, 0.25 * kStep}}, falling_at(1.0)).time.value(), -0.25 * kStep, 1e-12);
  EXPECT_NEAR(answer({{{0, 0, -0.1}, 0.01}}, falling_at(1.0)).time.value(), -kStep, 1e-12);
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
  EXPECT_NEAR(std::atan2(found.contacts[0].point.y(), found.contacts[0].point.x()), 20 * 0.5 * kStep, 1e-9);
}

TEST(TimedContacts, WhatRestsIsHeldAndWhatLeavesIsNot) {
  const double gap = 0.1 * kFall * kStep;
  const Answer resting = answer({{{0, 0, -0.1}, -gap}}, falling_at(0.0));
  ASSERT_EQ(resting.contacts.size(), 1U);
  EXPECT_FALSE(resting.time);
  EXPECT_NEAR(resting.contacts[0].lift, -gap / kStep, 1e-12);
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -gap}}, falling_at(-1.1 * kFall)).contacts.empty());
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -1.1 * kFall * kStep}}, falling_at(0.0)).contacts.empty());
}

TEST(TimedContacts, SlowLandingsAreOdesOwn) {
  EXPECT_TRUE(answer({{{0, 0, -0.1}, -1e-5}}, falling_at(kFall)).contacts.empty());
  const Answer landed = answer({{{0, 0, -0.1}, 1e-4}}, falling_at(kFall));
  ASSERT_EQ(landed.contacts.size(), 1U);
  EXPECT_FALSE(landed.time);
  EXPECT_EQ(landed.contacts[0].depth, 1e-4);
  EXPECT_EQ(landed.contacts[0].lift, 0.0);
}

TEST(TimedContacts, ALateImpulseMovesTheBodyForTheRestOfTheStepOnly) {
  const RigidState start = at({0, 0, 1}, {0, 0, -2}), kicked = at({0, 0, 1 + kStep}, {0, 0, 1}, {3, 0, 0},
                                                                  rotation_from_vector({3 * kStep, 0, 0}));
  const RigidState end = end_of_step(start, kicked, 0.25 * kStep);
  EXPECT_NEAR(end.position.z(), 1 - 2 * 0.25 * kStep + 0.75 * kStep, 1e-12);
  EXPECT_NEAR(2 * std::atan2(end.orientation.x(), end.orientation.w()), 3 * 0.75 * kStep, 1e-9);
  EXPECT_EQ(end.velocity, kicked.velocity);
}

}  // namespace
}  // namespace lodestone::timed_contacts_test
