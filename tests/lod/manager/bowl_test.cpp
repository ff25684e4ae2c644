// In hollows of triangles a wide body touches others than the one below its centre.
#include <gtest/gtest.h>

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

Mesh make_bowl() {
  constexpr int kRings = 10, kAround = 24;
  Mesh mesh;
  mesh.vertices.push_back(Vec3::Zero());
  for (int ring = 1; ring <= kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround, radius = kRim * ring / kRings;
      Vec3 at(radius * std::cos(angle), radius * std::sin(angle), 0.0);
      at.z() = height_of_bowl(at);
      mesh.vertices.push_back(at);
    }
  for (int i = 0; i < kAround; ++i) mesh.faces.push_back({0, 1 + i, 1 + (i + 1) % kAround});
  for (int ring = 1; ring < kRings; ++ring)
    for (int i = 0; i < kAround; ++i) {
      const int within = 1 + (ring - 1) * kAround, without = within + kAround, next = (i + 1) % kAround;
      mesh.faces.push_back({within + i, without + i, without + next});
      mesh.faces.push_back({within + i, without + next, within + next});
    }
  return mesh;
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

}  // namespace
}  // namespace lodestone::bowl_test
