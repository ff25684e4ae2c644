#include "reference/drop_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

double lowest_point(const Shape& shape, const RigidState& state, const Vec3& normal) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& v : shape.mesh.vertices)
    lowest = std::min(lowest, normal.dot(state.position + state.orientation * v));
  return lowest;
}

TEST(DropState, StaysWithinItsConditions) {
  const auto shape = box_shape({0.2, 0.3, 0.25});
  double least = 1.0, most = 0.0, slowest_fall = 1.0, fastest_fall = 0.0, fastest_spin = 0.0;
  for (std::uint32_t trial = 0; trial < 500; ++trial) {
    const RigidState state = drop_state(*shape, {}, 1, trial);
    const double low = lowest_point(*shape, state, Vec3::UnitZ());
    least = std::min(least, low), most = std::max(most, low);
    fastest_spin = std::max(fastest_spin, state.angular_velocity.norm());
    slowest_fall = std::min(slowest_fall, -state.velocity.z()),
    fastest_fall = std::max(fastest_fall, -state.velocity.z());
    ASSERT_LE(state.velocity.head<2>().cwiseAbs().maxCoeff(), 1.0);
    ASSERT_NEAR(state.orientation.norm(), 1.0, 1e-12);
  }
  EXPECT_GE(least, 0.3);
  EXPECT_LT(least, 0.31);
  EXPECT_LE(most, 0.8);
  EXPECT_GT(most, 0.79);
  EXPECT_GE(slowest_fall, 0.0);
  EXPECT_LE(fastest_fall, 1.0);
  EXPECT_GT(fastest_fall, 0.98);
  EXPECT_LE(fastest_spin, 10.0);
  EXPECT_GT(fastest_spin, 9.8);
}

TEST(DropState, DependsOnSeedAndTrialAlone) {
  const auto shape = box_shape({0.2, 0.3, 0.25});
  EXPECT_TRUE(same_bits(drop_state(*shape, {}, 1, 7), drop_state(*shape, {}, 1, 7)));
  EXPECT_FALSE(same_bits(drop_state(*shape, {}, 1, 7), drop_state(*shape, {}, 1, 8)));
  EXPECT_FALSE(same_bits(drop_state(*shape, {}, 1, 7), drop_state(*shape, {}, 2, 7)));
}

// Beyond .4 m lengths go with λ, times with √λ: a body four times as large starts from the same drop seen at
// half the pace.
TEST(DropState, ScalesWithTheBody) {
  const auto small = box_shape({0.3, 0.4, 0.35}), large = box_shape({1.2, 1.6, 1.4});
  const RigidState a = drop_state(*small, {}, 1, 3), b = drop_state(*large, {}, 1, 3);
  EXPECT_LT((b.position - 4.0 * a.position).norm(), 1e-12);
  EXPECT_LT((b.velocity - 2.0 * a.velocity).norm(), 1e-12);
  EXPECT_LT((b.angular_velocity - 0.5 * a.angular_velocity).norm(), 1e-12);
}

TEST(DropState, StartsAboveATiltedPlane) {
  const auto shape = box_shape({0.2, 0.3, 0.25});
  const DropConditions conditions{.slope = 0.4};
  const Vec3 normal = drop_plane_normal(conditions);
  EXPECT_NEAR(normal.norm(), 1.0, 1e-15);
  EXPECT_NEAR(std::acos(normal.z()), 0.4, 1e-12);
  EXPECT_EQ(normal.y(), 0.0);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const double low = lowest_point(*shape, drop_state(*shape, conditions, 1, trial), normal);
    EXPECT_GE(low, 0.3 - 1e-12);
    EXPECT_LE(low, 0.8);
  }
}

TEST(SimulateDrop, ObservesAtSixtyHertzUntilTheHorizonOrTheEnd) {
  const auto shape = box_shape({0.2, 0.3, 0.25});
  const MaterialTable materials;
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const OdeBodyId body = world.add_body({.shape = shape, .state = drop_state(*shape, {}, 1, 0)});
  const Vec3 start = world.state(body).position;
  std::vector<double> times;
  simulate_drop(world, body, 0.5, 4, [&](double time, const RigidState& state) {
    times.push_back(time);
    if (time == 0.0) {
      EXPECT_EQ(state.position, start);
    }
    return true;
  });
  ASSERT_EQ(times.size(), 31u);
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_NEAR(times.back(), 0.5, 1e-12);

  int calls = 0;
  simulate_drop(world, body, 0.5, 4, [&](double, const RigidState&) { return ++calls < 3; });
  EXPECT_EQ(calls, 3);
}

// Resting on its hull or on its mesh, a body comes down to the same height and contacts.
TEST(SimulateDrop, HullAndMeshContactsEndAlike) {
  const auto shape = box_shape({0.2, 0.3, 0.4});
  const MaterialTable materials;
  int alike = 0;
  for (std::uint32_t trial = 0; trial < 10; ++trial) {
    double height[2];
    for (const bool hull : {false, true}) {
      OdeWorld world({.plane_contacts_from_hull = hull}, materials);
      world.add_plane(Vec3::UnitZ(), 0.0, 0);
      const OdeBodyId body =
          world.add_body({.shape = shape, .mass = 24.0, .state = drop_state(*shape, {}, 1, trial)});
      simulate_drop(world, body, 4.0, 33, [](double, const RigidState&) { return true; });
      height[hull] = world.state(body).position.z();
    }
    for (const double h : height)
      EXPECT_TRUE(std::abs(h - 0.1) < 1e-3 || std::abs(h - 0.15) < 1e-3 || std::abs(h - 0.2) < 1e-3) << h;
    alike += std::abs(height[0] - height[1]) < 1e-3;
  }
  EXPECT_GE(alike, 8);
}

// ODE's collider of a mesh with a plane notes which vertices it used in a cache that all threads share.
TEST(SimulateDrop, MeshContactsDoNotDependOnOtherThreads) {
  const auto shape = box_shape({0.2, 0.3, 0.4});
  const MaterialTable materials;
  const auto fall = [&](std::uint32_t trial) {
    OdeWorld world({.plane_contacts_from_hull = false}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const OdeBodyId body =
        world.add_body({.shape = shape, .mass = 24.0, .state = drop_state(*shape, {}, 1, trial)});
    simulate_drop(world, body, 2.0, 33, [](double, const RigidState&) { return true; });
    return world.state(body);
  };
  constexpr std::uint32_t kTrials = 40;
  std::vector<RigidState> together(kTrials);
  const auto run = [&](std::uint32_t first) {
    for (std::uint32_t trial = first; trial < kTrials; trial += 2) together[trial] = fall(trial);
  };
  std::thread other(run, 1);
  run(0);
  other.join();
  for (std::uint32_t trial = 0; trial < kTrials; ++trial)
    EXPECT_TRUE(testing::same_bits(together[trial], fall(trial))) << trial;
}

}  // namespace
}  // namespace lodestone
