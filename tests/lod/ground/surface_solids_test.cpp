#include "lod/ground/surface_solids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "lod/ground/ground_solids.h"

namespace lodestone {
namespace {

// Of cells of a metre, in waves.
Mesh waves(int cells) {
  Mesh mesh;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x) mesh.vertices.emplace_back(x, y, 0.2 * std::sin(1.3 * x) * std::cos(y));
  const auto at = [&](int x, int y) { return y * (cells + 1) + x; };
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      mesh.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

TEST(SurfaceSolids, AreMadeWhereSomethingComesNear) {
  const SurfaceSolids surface(waves(20));
  ASSERT_EQ(surface.size(), 800U);
  EXPECT_EQ(surface.made(), 0U);
  const GroundSolid& solid = surface[7];
  EXPECT_EQ(surface.made(), 1U);
  EXPECT_EQ(&surface[7], &solid);
  ASSERT_TRUE(solid.surface);
  EXPECT_EQ(solid.shape->hull.vertices.size(), 6U);
  const Eigen::AlignedBox3d bounds = surface.bounds(7);
  for (const Vec3& v : solid.shape->hull.vertices)
    EXPECT_LT(bounds.squaredExteriorDistance(solid.center + v), 1e-24);
}

TEST(SurfaceSolids, CopiesOfAPartShareThem) {
  GroundSolids part;
  part.add_mesh(waves(20));
  part.prepare();
  const GroundSolids copy = part;
  std::vector<int> near;
  copy.find_near({5, 5, 0}, 1.0, near);
  ASSERT_FALSE(near.empty());
  for (const int i : near) EXPECT_EQ(&part[i], &copy[i]);
}

TEST(SurfaceSolids, OfManyThreadsAllGetTheSame) {
  const SurfaceSolids surface(waves(10));
  std::vector<std::vector<const GroundSolid*>> seen(4);
  {
    std::vector<std::jthread> threads;
    for (auto& own : seen)
      threads.emplace_back([&surface, &own] {
        for (std::size_t i = 0; i < surface.size(); ++i) own.push_back(&surface[i]);
      });
  }
  for (const auto& own : seen) EXPECT_EQ(own, seen.front());
  EXPECT_EQ(surface.made(), surface.size());
}

}  // namespace
}  // namespace lodestone
