// What hangs together in a crowd, and how it is to be solved.
#include "lod/contact/crowd_islands.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

struct IslandsOf {
  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  CrowdIslands islands;

  std::int32_t add(double mass, bool in_great_heap = false) {
    SolverBody& body = bodies.emplace_back();
    body.inverse_mass = mass > 0.0 ? 1.0 / mass : 0.0;
    body.in_great_heap = in_great_heap;
    return std::int32_t(bodies.size()) - 1;
  }
  std::size_t touch(std::int32_t first, std::int32_t second, std::uint32_t points = 4) {
    manifolds.push_back(
        {.first = first, .second = second, .normal = Vec3::UnitZ(), .law = {}, .count = points});
    return manifolds.size() - 1;
  }
  void find() { islands.find(bodies, manifolds); }
};

TEST(CrowdIslands, AreOfThoseThatTouchDirectlyOrThroughOthers) {
  IslandsOf scene;
  const std::int32_t a = scene.add(1), b = scene.add(2), c = scene.add(3), apart = scene.add(1);
  const std::size_t ab = scene.touch(a, b), bc = scene.touch(c, b), ground = scene.touch(apart, -1);
  scene.find();
  EXPECT_EQ(scene.islands.island_of(ab), scene.islands.island_of(bc));
  EXPECT_NE(scene.islands.island_of(ab), scene.islands.island_of(ground));
  for (const std::size_t manifold : {ab, bc, ground})
    EXPECT_EQ(scene.islands.kind_of(manifold), IslandKind::small);
  EXPECT_EQ(scene.islands.unevenness_of(ab), 2.0);
  EXPECT_EQ(scene.islands.unevenness_of(ground), 0.0);
}

TEST(CrowdIslands, WhatSleepsJoinsNobody) {
  IslandsOf scene;
  const std::int32_t sleeper = scene.add(0), one = scene.add(1), other = scene.add(1);
  const std::size_t first = scene.touch(one, sleeper), second = scene.touch(sleeper, other);
  scene.find();
  EXPECT_NE(scene.islands.island_of(first), scene.islands.island_of(second));
}

TEST(CrowdIslands, AreUnevenWhereAWeightMeetsALightBody) {
  IslandsOf scene;
  const std::int32_t light = scene.add(1), heavy = scene.add(50), beside = scene.add(1);
  const std::size_t uneven = scene.touch(heavy, light), with_them = scene.touch(light, beside);
  scene.find();
  EXPECT_EQ(scene.islands.kind_of(uneven), IslandKind::uneven);
  EXPECT_EQ(scene.islands.kind_of(with_them), IslandKind::uneven);
  for (const std::size_t manifold : {uneven, with_them})
    EXPECT_NEAR(scene.islands.unevenness_of(manifold), 50.0, 1e-4);
}

// A hundred bodies in a row; and two on one of a heap that sleeps, which are a part of that heap.
TEST(CrowdIslands, AreGreatWithManyPointsOrOnAHeapThatSleeps) {
  IslandsOf scene;
  std::int32_t last = scene.add(1);
  for (int i = 0; i < 99; ++i) {
    const std::int32_t next = scene.add(1);
    scene.touch(last, next);
    last = next;
  }
  const std::int32_t sleeper = scene.add(0, true), on_it = scene.add(1), on_that = scene.add(1),
                     lone = scene.add(1), alone = scene.add(1);
  const std::size_t left = scene.touch(on_it, sleeper);
  scene.touch(on_that, on_it);
  const std::size_t of_lone = scene.touch(lone, sleeper);
  scene.touch(alone, -1);
  scene.find();
  EXPECT_EQ(scene.islands.kind_of(0), IslandKind::great);
  EXPECT_EQ(scene.islands.kind_of(left), IslandKind::great);
  EXPECT_EQ(scene.islands.kind_of(of_lone), IslandKind::small);
  for (const std::int32_t body : {last, on_it, on_that, lone}) EXPECT_TRUE(scene.islands.in_great_heap(body));
  EXPECT_FALSE(scene.islands.in_great_heap(alone));
}

}  // namespace
}  // namespace lodestone
