// What a world does to stay within bounds: correcting velocity, contacts per pair, the solver's random numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

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
  const OdeBodyId first = world.add_body({.shape = cube}), second = world.add_body({.shape = cube, .state = at({0.5, 0.01, 0.02})});
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

RigidState top_of_quick_stack(std::uint64_t seed) {
  const MaterialTable materials = material(0.0, 0.5);
  OdeWorld world({.seed = seed, .quick_step = true}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto cube = box_shape(Vec3::Constant(0.5));
  OdeBodyId top;
  for (int i = 0; i < 4; ++i) {
    RandomStream random(9, i, 0);
    top = world.add_body({.shape = cube, .mass = 125.0, .state = at({random.uniform(-0.05, 0.05), 0, 0.26 + 0.51 * i})});
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
