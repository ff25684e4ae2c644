// What a world does to stay within bounds: correcting velocity, contacts per pair, the solver's random
// numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "reference/error.h"
#include "reference/hull/hull_overlap.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// Two cubes that overlap by half: how fast they come out.
double exit_speed(double max_correcting_velocity) {
  const MaterialTable materials = material(0.0, 0.0);
  OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = max_correcting_velocity}, materials);
  const auto cube = box_shape({1, 1, 1});
  const OdeBodyId first = world.add_body({.shape = cube}),
                  second = world.add_body({.shape = cube, .state = at({0.5, 0.01, 0.02})});
  double greatest = 0.0;
  for (int i = 0; i < 240; ++i) {
    world.step(1.0 / 240);
    greatest = std::max(greatest, (world.state(first).velocity - world.state(second).velocity).norm());
  }
  EXPECT_FALSE(find_hull_overlap(*cube, world.state(first), *cube, world.state(second)));
  return greatest;
}

TEST(OdeLimits, OverlapIsPushedApartNoFasterThanAsked) {
  EXPECT_NEAR(exit_speed(1.0), 1.0, 0.01);
  EXPECT_NEAR(exit_speed(2.0), 2.0, 0.02);
  EXPECT_GT(exit_speed(1e9), 10.0);  // ODE's own: a fifth of the depth in one step
}

TEST(OdeLimits, ContactsOfAPairAreCappedAndThoseDroppedAreCounted) {
  const MaterialTable materials;
  const auto round = std::make_shared<const Shape>(make_shape("round", make_sphere(0.5)));
  for (const int most : {1, 3, 8}) {
    OdeWorld world({.gravity = Vec3::Zero(), .max_contacts_per_pair = most}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    world.add_body({.shape = round, .state = at({0, 0, 0.4})});
    world.add_body({.shape = round, .state = at({0, 0, 1.3})});
    world.step(1e-3);
    std::map<std::uint32_t, int> contacts;  // of each pair, by its second body
    for (const OdeContact& contact : world.contacts()) ++contacts[contact.second.value];
    EXPECT_EQ(contacts.size(), 2U);
    for (const auto& [second, count] : contacts) EXPECT_LE(count, most);
    EXPECT_GT(world.counters().contacts_dropped, 0) << most;
    EXPECT_EQ(world.counters().contacts, std::int64_t(world.contacts().size()));
  }
}

// From ten milligrams to a million tonnes: boxes that fall on each other give ODE's solver as little to
// complain of as those of a kilogram do.
TEST(OdeLimits, LightestAndHeaviestBodiesPile) {
  for (const double mass : {1e-5, 1e-4, 1.0, 1e9}) {
    const MaterialTable materials;
    OdeWorld world({.direct_contacts_max = 150, .max_correcting_velocity = 1.0}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    std::vector<OdeBodyId> pile;
    for (int i = 0; i < 5; ++i)
      pile.push_back(world.add_body({.shape = box_shape({0.2, 0.3, 0.4}),
                                     .mass = mass,
                                     .state = at({0.02 * i, 0, 0.24 + 0.42 * i}, Vec3::Zero(), {1, 2, 3},
                                                 rotation_from_vector({0.1 * i, 0, 0}))}));
    for (int i = 0; i < 200; ++i) world.step(1.0 / 60, 4);
    for (const OdeBodyId body : pile) EXPECT_GT(world.state(body).position.z(), 0.09) << mass;
    EXPECT_EQ(world.counters().messages, 0) << mass;
    EXPECT_EQ(world.counters().states_recovered, 0) << mass;
  }
}

TEST(OdeLimits, WhatOdeWouldAbortOnIsRefused) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  const auto cube = box_shape({1, 1, 1});
  for (const double mass : {0.0, 1e-30, 1e-8, 1e300})
    EXPECT_THROW(world.add_body({.shape = cube, .mass = mass}), InputError) << mass;
  Shape thin = *cube;
  thin.inertia_per_mass = Mat3::Identity() * 1e-300;
  EXPECT_THROW(world.add_body({.shape = std::make_shared<const Shape>(thin)}), InputError);
  EXPECT_THROW(world.add_body({.shape = cube, .material = 7}), InputError);
  EXPECT_THROW(world.add_plane(Vec3::UnitZ(), 0.0, 7), InputError);
  EXPECT_THROW(world.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity(), -1), InputError);
  EXPECT_THROW(world.add_static_mesh(make_box({1, 1, 1}), 1), InputError);
  world.add_body({.shape = cube});
  EXPECT_THROW(world.step(5e-324), InputError);
  EXPECT_THROW(world.step(1e-3, 1 << 30), InputError);
  EXPECT_THROW(OdeWorld({.gravity = {0, 0, std::numeric_limits<double>::quiet_NaN()}}, materials),
               InputError);
  EXPECT_THROW(OdeWorld({.gravity = {0, std::numeric_limits<double>::infinity(), 0}}, materials), InputError);
}

RigidState top_of_quick_stack(std::uint64_t seed) {
  const MaterialTable materials = material(0.0, 0.5);
  OdeWorld world({.seed = seed, .quick_step = true}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto cube = box_shape(Vec3::Constant(0.5));
  OdeBodyId top;
  for (int i = 0; i < 4; ++i) {
    RandomStream random(9, i, 0);
    top = world.add_body(
        {.shape = cube, .mass = 125.0, .state = at({random.uniform(-0.05, 0.05), 0, 0.26 + 0.51 * i})});
  }
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  return world.state(top);
}

TEST(OdeLimits, QuickStepFollowsTheSeed) {
  EXPECT_TRUE(same_bits(top_of_quick_stack(1), top_of_quick_stack(1)));
  EXPECT_FALSE(same_bits(top_of_quick_stack(1), top_of_quick_stack(2)));
}

}  // namespace
}  // namespace lodestone
