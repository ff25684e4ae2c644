// Single bodies under ODE against what mechanics predicts.
#include "reference/ode/ode_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/error.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kTruthStep = 5e-4;
constexpr double kDegree = std::numbers::pi / 180.0;

// The height to which a body first rises again after it fell.
double rebound_height(OdeWorld& world, OdeBodyId body, double dt) {
  bool falling = true;
  double highest = 0.0;
  for (double t = 0.0; t < 3.0; t += dt) {
    world.step(dt);
    const RigidState state = world.state(body);
    if (state.velocity.z() > 0.0) falling = false;
    if (!falling) highest = std::max(highest, state.position.z());
    if (!falling && state.velocity.z() < 0.0) break;
  }
  return highest;
}

TEST(OdeWorld, SphereReboundsToRestitutionSquared) {
  const MaterialTable materials = material(0.5, 0.0);
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const double radius = 0.1, height = 1.0;
  const OdeBodyId ball =
      world.add_body({.shape = sphere_shape(radius), .state = at({0, 0, radius + height})});
  EXPECT_NEAR(rebound_height(world, ball, kTruthStep) - radius, 0.25 * height, 0.005);
}

TEST(OdeWorld, FlatBoxReboundsToRestitutionSquared) {
  const MaterialTable materials = material(0.5, 0.3);
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId box = world.add_body({.shape = box_shape({0.3, 0.2, 0.1}), .state = at({0, 0, 1.05})});
  EXPECT_NEAR(rebound_height(world, box, kTruthStep) - 0.05, 0.25, 0.005);
  EXPECT_LT(world.state(box).angular_velocity.norm(), 1e-9);
}

// One corner below the centre of mass at impact: the impulse acts through it, with the effective mass of a
// frictionless hit, 1/m + (r×n)·I⁻¹(r×n).
TEST(OdeWorld, CornerHitGivesTheFrictionlessImpulse) {
  const double e = 0.6, mass = 2.0;
  const MaterialTable materials = material(e, 0.0);
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto shape = box_shape({0.3, 0.2, 0.1});
  const Quat turned(Eigen::AngleAxisd(0.7, Vec3(1, 2, 0.5).normalized()));
  double lowest = 0.0;
  Vec3 corner = Vec3::Zero();
  for (const Vec3& v : shape->mesh.vertices)
    if (const Vec3 r = turned * v; r.z() < lowest) lowest = r.z(), corner = r;
  const Vec3 before(0.2, 0.1, -1.0);
  const OdeBodyId box = world.add_body(
      {.shape = shape, .mass = mass, .state = at({0, 0, -lowest + 2e-4}, before, Vec3::Zero(), turned)});
  while (world.state(box).velocity == before) world.step(kTruthStep / 8);

  const Mat3 inverse_inertia = turned.toRotationMatrix() * shape->inverse_inertia_per_mass / mass *
                               turned.toRotationMatrix().transpose();
  const Vec3 arm = corner.cross(Vec3::UnitZ());
  const double impulse = (1.0 + e) / (1.0 / mass + arm.dot(inverse_inertia * arm));
  EXPECT_NEAR((world.state(box).velocity - Vec3(0.2, 0.1, -1.0 + impulse / mass)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((world.state(box).angular_velocity - inverse_inertia * arm * impulse).norm(), 0.0, 1e-3);
}

TEST(OdeWorld, FreeFlightIsAParabola) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const Vec3 velocity(1, -2, 3);
  const OdeBodyId box =
      world.add_body({.shape = box_shape({0.3, 0.3, 0.3}), .state = at(Vec3::Zero(), velocity, {0, 0, 2})});
  const int steps = 1000;
  for (int i = 0; i < steps; ++i) world.step(1e-3);
  // ODE's semi-implicit Euler: after n steps the fall is g h² n (n + 1) / 2.
  const Vec3 expected = velocity - Vec3::UnitZ() * kGravity * 1e-6 * steps * (steps + 1) / 2.0;
  EXPECT_LT((world.state(box).position - expected).norm(), 1e-10);
  EXPECT_NEAR(2.0 * std::atan2(world.state(box).orientation.z(), world.state(box).orientation.w()), 2.0,
              1e-4);
}

TEST(OdeWorld, FreeTopNeverGainsEnergy) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const auto shape = box_shape({1, 2, 0.5});
  const OdeBodyId box =
      world.add_body({.shape = shape, .state = at(Vec3::Zero(), Vec3::Zero(), {0.01, 0.01, 10})});
  const double before = energy_of(*shape, 1.0, world.state(box));
  for (int i = 0; i < 10000; ++i) world.step(1e-3);
  EXPECT_LE(energy_of(*shape, 1.0, world.state(box)), before * (1.0 + 1e-3));
}

// Hard case F5: Coulomb's law whatever the compass direction of the slope.
class Slope : public ::testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(Slope, BoxSlidesOrSticksAsCoulombSays) {
  const auto [friction, azimuth] = GetParam();
  const double tilt = 25 * kDegree, seconds = 2.0;
  const MaterialTable materials = material(0.0, friction);
  OdeWorld world({}, materials);
  const Quat turn = Quat(Eigen::AngleAxisd(azimuth * kDegree, Vec3::UnitZ())) *
                    Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  world.add_plane(turn * Vec3::UnitZ(), 0.0, 0);
  // The box's own sides stay along x and y as far as the slope lets them.
  const Quat flat = Quat::FromTwoVectors(Vec3::UnitZ(), turn * Vec3::UnitZ());
  const OdeBodyId box =
      world.add_body({.shape = box_shape({0.4, 0.4, 0.2}),
                      .state = at(turn * Vec3(0, 0, 0.1), Vec3::Zero(), Vec3::Zero(), flat)});
  for (int i = 0; i < int(seconds / 1e-3); ++i) world.step(1e-3);
  const double expected = kGravity * (std::sin(tilt) - friction * std::cos(tilt)) * seconds;
  const double speed = world.state(box).velocity.norm();
  if (expected > 0.0)
    EXPECT_NEAR(speed, expected, 0.05 * expected);
  else
    EXPECT_LE(speed, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(OdeWorld, Slope,
                         ::testing::Combine(::testing::Values(0.45, 0.48, 0.55),
                                            ::testing::Values(0.0, 22.5, 45.0)));

TEST(OdeWorld, DropsLoseEnergy) {
  const MaterialTable materials;
  const auto shape = box_shape({0.2, 0.3, 0.4});
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId box = world.add_body({.shape = shape});
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    RandomStream random(1, trial, 0);
    world.set_state(box,
                    at({0, 0, 0.8}, random.direction(), 10.0 * random.direction(), random.orientation()));
    const double before = energy_of(*shape, 1.0, world.state(box));
    for (int i = 0; i < 4000; ++i) world.step(kTruthStep);
    const RigidState end = world.state(box);
    EXPECT_LT(energy_of(*shape, 1.0, end), 1.01 * before) << "trial " << trial;
    EXPECT_GT(end.position.z(), 0.098) << "trial " << trial;
  }
}

TEST(OdeWorld, ForcesLastOneStep) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero()}, materials);
  const OdeBodyId box = world.add_body({.shape = box_shape({1, 1, 1}), .mass = 2.0});
  world.add_force(box, {4, 0, 0}, {0, 0, 1.0 / 3.0});
  world.step(0.1, 4);
  EXPECT_NEAR(world.state(box).velocity.x(), 0.2, 1e-12);
  EXPECT_NEAR(world.state(box).angular_velocity.z(), 0.1, 1e-12);
  world.step(0.1, 4);
  EXPECT_NEAR(world.state(box).velocity.x(), 0.2, 1e-12);
}

TEST(OdeWorld, StateComesBackBitForBit) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const OdeBodyId box = world.add_body({.shape = box_shape({1, 1, 1})});
  for (std::uint32_t i = 0; i < 100; ++i) {
    RandomStream random(3, i, 0);
    const RigidState state =
        at(random.direction(), random.direction(), random.direction(), random.orientation());
    world.set_state(box, state);
    EXPECT_TRUE(same_bits(world.state(box), state));
  }
}

TEST(OdeWorld, UnboundedForceIsRecoveredAndCounted) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const RigidState start = at({1, 2, 3}, {1, 0, 0});
  const OdeBodyId box = world.add_body({.shape = box_shape({1, 1, 1}), .state = start});
  world.add_force(box, {1e300, 0, 0}, {0, 1e300, 0});
  world.step(1e-3);
  EXPECT_EQ(world.counters().states_recovered, 1);
  EXPECT_EQ(world.state(box).position, start.position);
  EXPECT_EQ(world.state(box).velocity, Vec3::Zero());
  world.step(1e-3);
  EXPECT_EQ(world.counters().states_recovered, 1);
}

TEST(OdeWorld, ContactsNameBodyPointAndNormal) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId box = world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.0995})});
  world.step(kTruthStep);
  ASSERT_EQ(world.contacts().size(), 4u);
  for (const OdeContact& contact : world.contacts()) {
    EXPECT_EQ(contact.first, box);
    EXPECT_FALSE(contact.second);
    EXPECT_EQ(contact.normal, Vec3::UnitZ());
    EXPECT_NEAR(contact.depth, 5e-4, 1e-12);
    EXPECT_NEAR(contact.point.cwiseAbs().x(), 0.1, 1e-12);
  }
  EXPECT_EQ(world.counters().contacts, 4);
}

TEST(OdeWorld, WhatCannotBeIsRefusedAndChangesNothing) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const auto shape = box_shape({1, 1, 1});
  const OdeBodyId box = world.add_body({.shape = shape});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double dt : {0.0, -0.1, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(world.step(dt), InputError);
  EXPECT_THROW(world.step(0.1, 0), InputError);
  for (const double mass : {0.0, -1.0, nan})
    EXPECT_THROW(world.add_body({.shape = shape, .mass = mass}), InputError);
  EXPECT_THROW(world.add_body({.shape = nullptr}), InputError);
  EXPECT_THROW(world.set_state(box, at({nan, 0, 0})), InputError);
  EXPECT_THROW(world.set_state(box, at({2e8, 0, 0})), InputError);
  EXPECT_THROW(world.set_state(box, at({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, Quat(0, 0, 0, 0))), InputError);
  EXPECT_THROW(world.add_force(box, {nan, 0, 0}, {0, 0, 0}), InputError);
  EXPECT_THROW(world.state({}), InputError);
  EXPECT_THROW(world.add_plane({0, 0, 2}, 0, 0), InputError);
  EXPECT_THROW(world.add_static_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, 0), InputError);
  EXPECT_THROW(world.add_static_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}}, 0),
               InputError);
  EXPECT_TRUE(same_bits(world.state(box), RigidState{}));
  world.remove_body(box);
  EXPECT_THROW(world.state(box), InputError);
}

}  // namespace
}  // namespace lodestone
