#include "lod/ground/surface_solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

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
  const Eigen::AlignedBox3d& bounds = surface.bounds();
  for (const Vec3& v : solid.shape->hull.vertices)
    EXPECT_LT(bounds.squaredExteriorDistance(solid.center + v), 1e-24);
}

// Boxes by their sides and middles, m.
Mesh boxes(const std::vector<std::pair<Vec3, Vec3>>& placed) {
  Mesh mesh;
  for (const auto& [sides, middle] : placed) {
    const Mesh box = make_box(sides);
    const int before = int(mesh.vertices.size());
    for (const Vec3& v : box.vertices) mesh.vertices.push_back(middle + v);
    for (const auto& f : box.faces) mesh.faces.push_back({f[0] + before, f[1] + before, f[2] + before});
  }
  return mesh;
}

// m: how far below the triangle that has `normal` and lies at `height` along it its solid reaches, at most.
double depth_of(const SurfaceSolids& surface, const Vec3& normal, double height) {
  double depth = -1.0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const GroundSolid& solid = surface[i];
    if (solid.surface->normal.dot(normal) < 0.999) continue;
    if (std::abs(solid.surface->corner[0].dot(normal) - height) > 1e-9) continue;
    for (const Vec3& v : solid.shape->hull.vertices)
      depth = std::max(depth, height - (solid.center + v).dot(normal));
  }
  return depth;
}

TEST(SurfaceSolids, AreNoDeeperThanTheSurfaceIsThick) {
  // A floor of 1 m, a table top of 5 cm over it, and a pedestal that is let into the floor by 1 cm.
  const SurfaceSolids surface(
      boxes({{{20, 20, 1}, {0, 0, -0.5}}, {{1.5, 1.5, 0.05}, {3, 0, 1.0}}, {{1, 1, 1}, {-3, 0, 0.49}}}));
  const double usual = 0.02 * std::sqrt(20 * 20 + 20 * 20 + 2.025 * 2.025);
  EXPECT_NEAR(depth_of(surface, Vec3::UnitZ(), 0.0), usual, 1e-9);
  EXPECT_NEAR(depth_of(surface, Vec3::UnitZ(), 1.025), 0.05, 1e-6);
  EXPECT_NEAR(depth_of(surface, -Vec3::UnitZ(), -0.975), 0.05, 1e-6);
  EXPECT_NEAR(depth_of(surface, Vec3::UnitX(), -2.5), usual, 1e-9);
  EXPECT_NEAR(depth_of(surface, Vec3::UnitZ(), 0.99), usual, 1e-9);
}

// However long the step is beside its height: over what stands out nothing is met along a riser's normal.
TEST(SurfaceSolids, EdgesOfWideStepsStandOut) {
  for (const double wide : {1.0, 4.0, 40.0}) {  // m
    const SurfaceSolids surface(boxes({{{1, wide, 0.2}, {0, 0, 0}}}));
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const SurfaceTriangle& triangle = *surface[i].surface;
      for (int edge = 0; edge < 3; ++edge) {
        const Vec3 along = triangle.corner[std::size_t((edge + 1) % 3)] - triangle.corner[std::size_t(edge)];
        int directions = 0;  // the diagonals of its faces do not
        for (const double x : along) directions += std::abs(x) > 1e-9;
        EXPECT_EQ(triangle.ridge[std::size_t(edge)], directions == 1) << wide << " m, " << i;
      }
    }
  }
}

// It has no other side itself: what lies below it is none the thicker.
TEST(SurfaceSolids, ASheetAboveMakesNothingThick) {
  Mesh mesh = boxes({{{3, 3, 0.05}, {0, 0, 1}}});
  const int first = int(mesh.vertices.size());
  for (const Vec3& v : {Vec3(-5, -5, 4), Vec3(5, -5, 4), Vec3(5, 5, 4), Vec3(-5, 5, 4)})
    mesh.vertices.push_back(v);
  mesh.faces.push_back({first, first + 1, first + 2}), mesh.faces.push_back({first, first + 2, first + 3});
  const SurfaceSolids surface(mesh);
  EXPECT_NEAR(depth_of(surface, Vec3::UnitZ(), 1.025), 0.05, 1e-6);
  EXPECT_NEAR(depth_of(surface, -Vec3::UnitZ(), -0.975), 0.05, 1e-6);
  EXPECT_GT(depth_of(surface, Vec3::UnitZ(), 4.0), 0.2);
}

TEST(SurfaceSolids, TaperWhereTheSurfaceDoes) {
  Mesh wedge;  // its edge along y at x = 0, .4 m thick at x = 2
  wedge.vertices = {{0, 0, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {2, 0, 0.4}, {2, 1, 0.4}};
  wedge.faces = {{0, 3, 2}, {0, 1, 3}, {0, 4, 5}, {0, 5, 1}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
  const SurfaceSolids surface(wedge);
  for (std::size_t i = 0; i < surface.size(); ++i)
    for (const Vec3& v : surface[i].shape->hull.vertices) {
      const Vec3 at = surface[i].center + v;
      EXPECT_GT(at.z(), -0.005) << i;
      EXPECT_LT(at.z(), 0.2 * at.x() + 0.005) << i;
    }
}

TEST(SurfaceSolids, OfASheetThatIsThereBothWaysAreThin) {
  Mesh sheet = waves(4);
  for (std::size_t i = 0, count = sheet.faces.size(); i < count; ++i)
    sheet.faces.push_back({sheet.faces[i][0], sheet.faces[i][2], sheet.faces[i][1]});
  const SurfaceSolids surface(sheet);
  for (std::size_t i = 0; i < surface.size(); ++i) EXPECT_LT(surface[i].surface->depth, 1e-3);
}

// In a mesh that is not flat as a whole: a sheet 1 m over a box, and a pedestal that stands on that.
TEST(SurfaceSolids, OfASheetWhoseSidesAreDividedOtherwiseAreThin) {
  Mesh mesh = boxes({{{4, 4, 1}, {0, 0, -0.5}}, {{1, 1, 0.5}, {0.1, 0.2, 0.25}}});
  const int first = int(mesh.vertices.size());
  for (const Vec3& v : {Vec3(-2, -2, 1), Vec3(2, -2, 1), Vec3(2, 2, 1), Vec3(-2, 2, 1)})
    mesh.vertices.push_back(v);
  for (const auto& f : {std::array{0, 1, 2}, {0, 2, 3}, {3, 1, 0}, {3, 2, 1}})
    mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
  const SurfaceSolids surface(mesh);
  EXPECT_LT(depth_of(surface, Vec3::UnitZ(), 1.0), 2e-3);
  EXPECT_LT(depth_of(surface, -Vec3::UnitZ(), -1.0), 2e-3);
  EXPECT_GT(depth_of(surface, Vec3::UnitZ(), 0.0), 0.1);
}

TEST(SurfaceSolids, OfARoomWithoutAnOuterSkinAreDeep) {
  Mesh room = boxes({{{4, 4, 3}, {0, 0, 1.5}}});
  for (auto& f : room.faces) std::swap(f[1], f[2]);  // seen from inside
  const SurfaceSolids surface(room);
  for (std::size_t i = 0; i < surface.size(); ++i)
    EXPECT_NEAR(surface[i].surface->depth, 0.02 * std::sqrt(16.0 + 16.0 + 9.0), 1e-9);
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
