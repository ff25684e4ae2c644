// Concave bodies that are in each other, as they may be where they come from `tables`.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "reference/mesh/mesh.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// A plate of .5 m on four legs of .35, all .05 m thick.
Mesh make_four_legged() {
  constexpr std::array kAcross{-0.25, -0.2, 0.2, 0.25};
  constexpr std::array kUp{-0.375, -0.025, 0.025};
  const auto is_solid = [](int i, int j, int k) {
    const auto is_at_side = [](int at) { return at == 0 || at == 2; };
    const bool within = i >= 0 && i < 3 && j >= 0 && j < 3 && k >= 0 && k < 2;
    return within && (k == 1 || (is_at_side(i) && is_at_side(j)));
  };
  Mesh mesh;
  const auto corner = [&](const std::array<int, 3>& at) {
    const Vec3 place(kAcross[std::size_t(at[0])], kAcross[std::size_t(at[1])], kUp[std::size_t(at[2])]);
    const auto known = std::ranges::find(mesh.vertices, place);
    if (known != mesh.vertices.end()) return int(known - mesh.vertices.begin());
    mesh.vertices.push_back(place);
    return int(mesh.vertices.size()) - 1;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 2; ++k)
        for (int axis = 0; is_solid(i, j, k) && axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside{i, j, k};
            beside[std::size_t(axis)] += side ? 1 : -1;
            if (is_solid(beside[0], beside[1], beside[2])) continue;
            std::array<int, 4> face{};
            for (int n = 0; n < 4; ++n) {
              std::array<int, 3> at{i, j, k};
              at[std::size_t(axis)] += side;
              at[std::size_t((axis + 1) % 3)] += n == 1 || n == 2;
              at[std::size_t((axis + 2) % 3)] += n >= 2;
              face[std::size_t(side ? n : 3 - n)] = corner(at);
            }
            mesh.faces.push_back({face[0], face[1], face[2]}),
                mesh.faces.push_back({face[0], face[2], face[3]});
          }
  return mesh;
}

// A leg through the other's plate: pushed out of it both ways, they stayed where they were, and awake.
TEST(Entangled, WhatIsStuckInAnotherComesToRest) {
  const auto shape = std::make_shared<const Shape>(make_shape("four-legged", make_four_legged()));
  for (const double over : {0.05, 0.1, 0.2}) {
    Manager manager = on_floor();
    RigidState upper = testing::at({0.15, 0.13, 0.425 + over});
    upper.orientation = Eigen::AngleAxisd(0.3, Vec3::UnitZ());
    const std::vector<BodyId> both{add(manager, shape, testing::at({0, 0, 0.375}), LevelChoice::support),
                                   add(manager, shape, upper, LevelChoice::support)};
    run(manager, 4.0);
    for (const BodyId body : both) EXPECT_TRUE(manager.asleep(body)) << over;
  }
}

// 8,578 m/s, of a kick of 2.4 at most.
TEST(Entangled, HeapsThatComeNearAndAreStruckThrowNobody) {
  const auto shape = std::make_shared<const Shape>(make_shape("four-legged", make_four_legged()));
  std::mt19937 random(3);
  const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  Manager manager = on_floor({.signatures = coarse_signature});
  std::vector<BodyId> bodies;
  for (int heap = 0; heap < 24; ++heap)
    for (int i = 0; i < 12; ++i) {
      RigidState state = testing::at({4.0 * heap, 0.2 * some(), 0.5 + 0.9 * i});
      state.orientation = Quat(some(), some(), some(), some()).normalized();
      bodies.push_back(add(manager, shape, state, LevelChoice::tables));
    }
  run(manager, 6.0);
  for (const BodyId body : bodies) manager.set_level(body, LevelChoice::support);
  run(manager, 0.5);
  for (const BodyId body : bodies)
    manager.add_impulse(body, manager.mass(body) * Vec3(some(), some(), 1.0 + some()),
                        manager.state(body).position);
  double fastest = 0.0;  // m/s
  for (int i = 0; i < 240; ++i) {
    manager.step(kFrame);
    for (const BodyId body : bodies) fastest = std::max(fastest, manager.state(body).velocity.norm());
  }
  EXPECT_LT(fastest, 3.0);
}

// Brackets on each other: tipped into the lower one, lifted out of it and tipped again as they sank, one pair
// in forty walked about for ever.
TEST(Entangled, PairsOfBracketsComeToRestAtTables) {
  Manager manager = on_floor({.signatures = coarse_signature});
  const auto bracket = std::make_shared<const Shape>(make_shape("bracket", make_l(0.4, 0.4, 0.08, 0.12)));
  std::mt19937 random(1);
  const auto some = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  std::vector<BodyId> bodies;
  for (int i = 0; i < 2400; ++i) {
    RigidState state = testing::at({3.0 * (i / 2 % 40), 3.0 * (i / 80), 0.4 + 0.7 * (i % 2)});
    state.velocity = 0.3 * Vec3(some(), some(), 0);
    state.orientation = Quat(some(), some(), some(), some()).normalized();
    bodies.push_back(add(manager, bracket, state, LevelChoice::tables));
  }
  run(manager, 30.0);
  EXPECT_EQ(manager.report().asleep, int(bodies.size()));
}

}  // namespace
}  // namespace lodestone
