#include "signature/measure/collision_vectors.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kPi = std::numbers::pi;

MeasuredCollision draw_collision(RandomStream& random) {
  MeasuredCollision c;
  c.normal = random.direction();
  do c.velocity_before = random.uniform(0.1, 5) * random.direction();
  while (c.velocity_before.dot(c.normal) > -0.05);
  c.angular_velocity_before = random.uniform(0, 9) * random.direction();
  c.velocity_after = random.uniform(0, 3) * random.direction();
  c.angular_velocity_after = random.uniform(0, 9) * random.direction();
  return c;
}

MeasuredCollision turned(MeasuredCollision c, const Mat3& turn, double of_spins) {
  for (Vec3* v : {&c.velocity_before, &c.normal, &c.velocity_after}) *v = turn * *v;
  for (Vec3* w : {&c.angular_velocity_before, &c.angular_velocity_after}) *w = of_spins * (turn * *w);
  return c;
}

void expect_same(const CollisionConfiguration& a, const CollisionConfiguration& b) {
  EXPECT_NEAR(a.theta, b.theta, 1e-9);
  EXPECT_NEAR(a.phi, b.phi, 1e-9);
  EXPECT_NEAR(std::remainder(a.psi - b.psi, 2 * kPi), 0.0, 1e-7);
  EXPECT_NEAR(a.speed, b.speed, 1e-9);
  EXPECT_NEAR(a.spin, b.spin, 1e-9);
}

// However the world is turned: the same numbers, and the same response.
TEST(CollisionVectorsProperties, DoNotHangOnTheFrame) {
  RandomStream random(5, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const MeasuredCollision c = draw_collision(random);
    const MeasuredCollision other = turned(c, random.orientation().toRotationMatrix(), 1.0);
    expect_same(configuration_of(c, 0.3), configuration_of(other, 0.3));
    EXPECT_LT((response_of(c, 0.3, 0.4) - response_of(other, 0.3, 0.4)).norm(), 1e-5);
  }
}

// In a mirror a spin turns the other way about: ψ goes to π − ψ or the like, the angles between stay.
TEST(CollisionVectorsProperties, AMirrorKeepsTheAnglesOfTheVelocity) {
  RandomStream random(6, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const MeasuredCollision c = draw_collision(random);
    const Vec3 across = random.direction();
    const Mat3 mirror = Mat3::Identity() - 2.0 * across * across.transpose();
    const MeasuredCollision other = turned(c, mirror, -1.0);  // spins are axial
    const CollisionConfiguration a = configuration_of(c, 0.3), b = configuration_of(other, 0.3);
    EXPECT_NEAR(a.theta, b.theta, 1e-9);
    EXPECT_NEAR(a.phi, kPi - b.phi, 1e-9);
    EXPECT_NEAR(a.spin, b.spin, 1e-9);
    const Response there = response_of(c, 0.3, 0.4), back = response_of(other, 0.3, 0.4);
    EXPECT_NEAR(there.head<3>().norm(), back.head<3>().norm(), 1e-5);
    EXPECT_NEAR(there.tail<3>().norm(), back.tail<3>().norm(), 1e-5);
  }
}

// Twice as fast, or half as large and turning twice as fast: the same response.
TEST(CollisionVectorsProperties, AreWithoutUnits) {
  RandomStream random(7, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const MeasuredCollision c = draw_collision(random);
    MeasuredCollision fast = c, small = c;
    for (Vec3* v : {&fast.velocity_before, &fast.velocity_after, &fast.angular_velocity_before,
                    &fast.angular_velocity_after})
      *v *= 2.0;
    for (Vec3* w : {&small.angular_velocity_before, &small.angular_velocity_after}) *w *= 2.0;
    EXPECT_LT((response_of(c, 0.3, 0.4) - response_of(fast, 0.3, 0.4)).norm(), 1e-6);
    EXPECT_LT((response_of(c, 0.3, 0.4) - response_of(small, 0.15, 0.4)).norm(), 1e-6);
    EXPECT_NEAR(configuration_of(fast, 0.3).alpha(), configuration_of(c, 0.3).alpha(), 1e-12);
  }
}

// A particle's own bounce is no response; a body that goes straight on has (1 + e) along the normal.
TEST(CollisionVectorsProperties, AParticlesBounceIsZero) {
  RandomStream random(8, 0, 0);
  for (const double e : {0.0, 0.4, 1.0}) {
    MeasuredCollision c = draw_collision(random);
    c.angular_velocity_before = c.angular_velocity_after = Vec3::Zero();
    c.velocity_after = c.velocity_before - (1 + e) * c.velocity_before.dot(c.normal) * c.normal;
    EXPECT_LT(response_of(c, 0.3, e).norm(), 1e-6);
    c.velocity_after = c.velocity_before;
    const Response response = response_of(c, 0.3, e);
    const double theta = configuration_of(c, 0.3).theta;
    EXPECT_NEAR(response[0], -(1 + e) * std::cos(theta), 1e-5);
    EXPECT_NEAR(response.tail<5>().norm(), 0.0, 1e-6);
  }
}

TEST(CollisionVectorsProperties, AngleOfAFallIsToTheNormal) {
  MeasuredCollision c;
  for (const double theta : {0.0, 0.3, 1.2, kPi / 2 - 1e-6}) {
    c.velocity_before = Vec3(std::sin(theta), 0, -std::cos(theta));
    EXPECT_NEAR(configuration_of(c, 0.2).theta, theta, 1e-9);
  }
  c.velocity_before = Vec3(0, 0, -2);
  c.angular_velocity_before = Vec3(0, 0, 3);
  EXPECT_NEAR(configuration_of(c, 0.2).phi, kPi, 1e-12);
  EXPECT_NEAR(configuration_of(c, 0.2).spin, 0.6, 1e-12);
}

}  // namespace
}  // namespace lodestone
