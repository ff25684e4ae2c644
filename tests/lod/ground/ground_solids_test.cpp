#include "lod/ground/ground_solids.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/error.h"
#include "reference/random.h"

namespace lodestone {
namespace {

std::vector<Vec3> corners_of_box(const Vec3& sides, const Vec3& center = Vec3::Zero()) {
  std::vector<Vec3> corners;
  for (const Vec3& vertex : make_box(sides).vertices) corners.push_back(vertex + center);
  return corners;
}

// Where a solid holds a point of the part's frame.
bool holds(const GroundSolid& solid, const Vec3& point) {
  return std::ranges::all_of(solid.faces, [&](const SolidFace& face) {
    return face.normal.dot(point - solid.center) <= face.offset + 1e-12;
  });
}

TEST(GroundSolids, ABoxIsOneSolidOfSixFaces) {
  GroundSolids solids;
  const Vec3 center(5, 6, 7);
  solids.add_hull(corners_of_box({1, 2, 3}, center));
  solids.prepare();
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_EQ(solids[0].faces.size(), 6U);  // each normal once, though a side is two triangles
  EXPECT_LT((solids[0].center - center).norm(), 1e-12);
  EXPECT_TRUE(holds(solids[0], center + Vec3(0.49, 0.99, 1.49)));
  EXPECT_FALSE(holds(solids[0], center + Vec3(0.51, 0, 0)));
  EXPECT_LT((solids.bounds().sizes() - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_FALSE(solids[0].surface);
}

TEST(GroundSolids, APlateWithoutThicknessIsRefused) {
  GroundSolids solids;
  EXPECT_THROW(solids.add_hull(corners_of_box({1, 1, 0})), InputError);
}

// As one solid where it is convex, as its convex pieces where it is not, and all of it, none beside it.
TEST(GroundSolids, MeshesOfFewFacesAreTheirConvexPieces) {
  GroundSolids box, l;
  box.add_mesh(make_box({1, 1, 1}));
  EXPECT_EQ(box.size(), 1U);
  const Mesh mesh = make_l(0.3, 0.2, 0.08, 0.1);
  l.add_mesh(mesh);
  l.prepare();
  EXPECT_GE(l.size(), 2U);
  double least_x = 1e9, least_y = 1e9;
  for (const Vec3& vertex : mesh.vertices)
    least_x = std::min(least_x, vertex.x()), least_y = std::min(least_y, vertex.y());
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 2'000; ++i) {
    const Vec3 at(random.uniform(0, 0.3), random.uniform(0, 0.2), random.uniform(-0.049, 0.049));
    const bool inside = at.x() < 0.08 || at.y() < 0.08;  // in a leg
    bool held = false;
    for (std::size_t k = 0; k < l.size(); ++k)
      held = held || holds(l[int(k)], at + Vec3(least_x, least_y, 0.0));
    EXPECT_EQ(held, inside) << at.transpose();
  }
}

// A roof of two triangles: their ridge stands out, their border does, the seam of a flat floor does not.
TEST(GroundSolids, OfASurfaceTheRidgesAreKnown) {
  for (const double drop : {0.0, 0.5, -0.5}) {
    GroundSolids solids;
    solids.add_mesh(
        {{Vec3(0, -1, 0), Vec3(0, 1, 0), Vec3(-1, 0, -drop), Vec3(1, 0, -drop)}, {{0, 1, 2}, {1, 0, 3}}});
    solids.prepare();
    ASSERT_EQ(solids.size(), 2U);
    for (int i = 0; i < 2; ++i) {
      ASSERT_TRUE(solids[i].surface);
      const SurfaceTriangle& triangle = *solids[i].surface;
      EXPECT_GT(triangle.normal.z(), 0.5);
      for (int edge = 0; edge < 3; ++edge) {
        const Vec3 &a = triangle.corner[std::size_t(edge)], &b = triangle.corner[std::size_t(edge + 1) % 3];
        const bool shared = std::abs(a.x()) < 1e-9 && std::abs(b.x()) < 1e-9;
        EXPECT_EQ(triangle.ridge[std::size_t(edge)], !shared || drop > 0.0) << drop;
      }
    }
  }
}

TEST(GroundSolids, FacesWithoutAreaAreLeftOut) {
  GroundSolids solids;
  solids.add_mesh({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(2, 0, 0)}, {{0, 1, 2}, {0, 1, 3}}});
  EXPECT_EQ(solids.size(), 1U);
}

TEST(GroundSolids, AClosedMeshThatIsFlatIsASheet) {
  const std::vector<Vec3> corners{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  GroundSolids square, triangle;
  square.add_mesh({corners, {{0, 1, 2}, {0, 2, 3}, {3, 1, 0}, {3, 2, 1}}});
  triangle.add_mesh({{corners.begin(), corners.begin() + 3}, {{0, 1, 2}, {2, 1, 0}}});
  EXPECT_EQ(square.size(), 4U);
  EXPECT_EQ(triangle.size(), 2U);
  for (const GroundSolids* solids : {&square, &triangle})
    for (int i = 0; i < int(solids->size()); ++i) EXPECT_LT((*solids)[i].surface->depth, 2e-3) << i;
}

TEST(GroundSolids, WhatIsNearIsThatOfALookAtEach) {
  GroundSolids solids;
  RandomStream random(4, 0, 0);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int i = 0; i < 100; ++i) {
    const Vec3 center(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)), sides(1, 2, 0.5);
    solids.add_hull(corners_of_box(sides, center));
    boxes.emplace_back(Vec3(center - 0.5 * sides), Vec3(center + 0.5 * sides));
  }
  solids.prepare();
  for (int i = 0; i < 200; ++i) {
    const Vec3 at(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const double reach = random.uniform(0, 3);
    std::vector<int> found;
    solids.find_near(at, reach, found);
    std::ranges::sort(found);
    for (int k = 0; k < 100; ++k) {
      if (boxes[std::size_t(k)].exteriorDistance(at) < reach) {
        EXPECT_TRUE(std::ranges::binary_search(found, k));
      }
    }
    EXPECT_LE(found.size(), 60U);
  }
}

}  // namespace
}  // namespace lodestone
