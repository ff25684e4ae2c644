// In hollows of triangles a wide body touches others than the one below its centre.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lod/manager.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::bowl_test {
namespace {

constexpr double kRim = 3.0, kDepth = 1.6;  // m

double height_of_bowl(const Vec3& at) { return kDepth * (at.head<2>() / kRim).squaredNorm(); }

/// Rings of `around` points about a middle one: `at(share of the way to the rim, angle)`.
template <class At>
Mesh make_hollow(int rings, int around, At at) {
  Mesh mesh;
  mesh.vertices.push_back(Vec3::Zero());
  for (int ring = 1; ring <= rings; ++ring)
    for (int i = 0; i < around; ++i)
      mesh.vertices.push_back(at(double(ring) / rings, 2.0 * std::numbers::pi * i / around));
  for (int i = 0; i < around; ++i) mesh.faces.push_back({0, 1 + i, 1 + (i + 1) % around});
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const int within = 1 + (ring - 1) * around, without = within + around, next = (i + 1) % around;
      mesh.faces.push_back({within + i, without + i, without + next});
      mesh.faces.push_back({within + i, without + next, within + next});
    }
  return mesh;
}

Mesh make_bowl() {
  return make_hollow(10, 24, [](double share, double angle) {
    Vec3 at(kRim * share * std::cos(angle), kRim * share * std::sin(angle), 0.0);
    at.z() = height_of_bowl(at);
    return at;
  });
}

/// Of those over the bowl: who has come over its rim falls.
int count_below(const Manager& manager, const std::vector<BodyId>& bodies) {
  return int(std::ranges::count_if(bodies, [&](BodyId body) {
    const Vec3 at = manager.state(body).position;
    return at.head<2>().norm() < kRim && at.z() < height_of_bowl(at) - 0.1;
  }));
}

// Nobody met the others, whom its corner had come into: seven of 200, and two of a thousand alone.
TEST(Bowl, HoldsWideBodiesOfTables) {
  const auto slab = testing::box_shape({0.4, 0.4, 0.1});
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_mesh(make_bowl());
    std::mt19937 random(seed);
    const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
    std::vector<BodyId> bodies;
    for (int i = 0; i < 20; ++i) {
      RigidState state = testing::at({some(), some(), 1.2 + 0.6 * i});
      const Eigen::Vector4d turn(some(), some(), some(), some());
      state.orientation = Quat(turn[0], turn[1], turn[2], turn[3]).normalized();
      bodies.push_back(testing::add(manager, slab, state, LevelChoice::tables));
    }
    for (int i = 0; i < 50; ++i) {
      testing::run(manager, 0.1);
      ASSERT_EQ(count_below(manager, bodies), 0) << seed << ", after " << i;
    }
  }
}

TEST(Bowl, HoldsWideBodiesOfTablesThatAreAlone) {
  const auto slab = testing::box_shape({0.4, 0.4, 0.1});
  Manager manager({.signatures = testing::coarse_signature});
  manager.add_static_mesh(make_bowl());
  std::mt19937 random(1);
  const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  for (int i = 0; i < 1500; ++i) {
    RigidState state = testing::at({some(), some(), 3.0});
    const Eigen::Vector4d turn(some(), some(), some(), some());
    state.orientation = Quat(turn[0], turn[1], turn[2], turn[3]).normalized();
    const BodyId body = testing::add(manager, slab, state, LevelChoice::tables);
    testing::run(manager, 1.0);
    EXPECT_EQ(count_below(manager, {body}), 0) << i;
    manager.remove_body(body);
  }
}

/// What is left after a minute of the energy that a ball of .1 m has over the deepest point: it begins .4 m
/// aside.
double energy_left(Manager& manager, LevelChoice level) {
  const auto ball = testing::sphere_shape(0.1);
  const BodyId body = testing::add(manager, ball, testing::at({0.4, 0.02, 0.15}), level);
  const auto energy = [&] {
    const RigidState state = manager.state(body);
    const double inertia = ball->inertia_per_mass(0, 0);
    return 0.5 * state.velocity.squaredNorm() + 0.5 * inertia * state.angular_velocity.squaredNorm() +
           9.81 * (state.position.z() - 0.1);
  };
  const double before = energy();
  testing::run(manager, 60.0);
  return energy() / before;
}

/// Of a sphere of 2 m, in facets of 4 cm.
Mesh make_dish() {
  return make_hollow(48, 96, [](double share, double angle) {
    constexpr double kRadius = 2.0, kWidest = 0.9;  // m, rad
    const double polar = kWidest * share;
    return Vec3(kRadius * Vec3(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                               1.0 - std::cos(polar)));
  });
}

// It swung ever higher: one plane stood for a step, that below where it began.
TEST(Bowl, ABallInItGainsNoEnergy) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_mesh(make_dish());
    const double left = energy_left(manager, level);
    EXPECT_LT(left, 1.0) << int(level);
    EXPECT_GT(left, 0.6) << int(level);
  }
}

TEST(Bowl, ABallInAValleyOfTheCallersGainsNoEnergy) {
  const auto height = [](void*, int x, int) { return 0.25 * std::pow((x - 64) / 16.0, 2); };
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables}) {
    dInitODE2(0);
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, 0, -9.81);
    const dSpaceID space = dHashSpaceCreate(nullptr);
    const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
    dGeomHeightfieldDataBuildCallback(data, nullptr, height, 8, 8, 129, 129, 1, 0, 1, 0);
    dGeomHeightfieldDataSetBounds(data, 0, 20);
    dMatrix3 upright;
    dRFromAxisAndAngle(upright, 1, 0, 0, std::numbers::pi / 2);
    dGeomSetRotation(dCreateHeightfield(space, data, 1), upright);
    {
      Manager manager(world, space, {.signatures = testing::coarse_signature});
      const double left = energy_left(manager, level);
      EXPECT_LT(left, 0.9) << int(level);
      EXPECT_GT(left, 0.25) << int(level);
    }
    dSpaceDestroy(space), dWorldDestroy(world);
    dGeomHeightfieldDataDestroy(data);
  }
}

}  // namespace
}  // namespace lodestone::bowl_test
