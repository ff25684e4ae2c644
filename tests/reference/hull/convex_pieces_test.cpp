#include "reference/hull/convex_pieces.h"

#include <gtest/gtest.h>

#include "reference/mesh/inside.h"
#include "reference/mesh/mass_properties.h"
#include "reference/random.h"
#include "reference/shape.h"

namespace lodestone {
namespace {

double volume_of(const Hull& hull) { return measure_mass_properties({hull.vertices, hull.faces}).volume; }

bool is_inside(const Hull& hull, const Vec3& point) {
  for (int i = 0; i < int(hull.faces.size()); ++i)
    if (hull.face_normals[i].dot(point - hull.vertices[hull.faces[i][0]]) > 0.0) return false;
  return true;
}

/// A letter of unit thickness over the corners of its outline, triangulated by `caps`.
Mesh extrude(const std::vector<std::array<double, 2>>& outline, const std::vector<std::array<int, 3>>& caps) {
  Mesh mesh;
  const int n = int(outline.size());
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh.vertices.push_back({x, y, z});
  for (const auto& [a, b, c] : caps) {
    mesh.faces.push_back({c, b, a});
    mesh.faces.push_back({a + n, b + n, c + n});
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.faces.push_back({i, j, j + n});
    mesh.faces.push_back({i, j + n, i + n});
  }
  return mesh;
}

Mesh make_u() {
  return extrude({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                 {{0, 5, 7}, {5, 6, 7}, {0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}});
}

TEST(ConvexPieces, OfAConvexSolidAreItself) {
  const Shape box = make_shape("box", make_box({1, 2, 3}));
  const auto pieces = find_convex_pieces(box.mesh, box.hull);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_NEAR(volume_of(pieces[0]), 6.0, 1e-9);
}

TEST(ConvexPieces, OfAnLAreItsWholeLegs) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1));
  const auto pieces = find_convex_pieces(l.mesh, l.hull);
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_NEAR(volume_of(pieces[0]), 0.3 * 0.08 * 0.1, 1e-9);
  EXPECT_NEAR(volume_of(pieces[1]), 0.2 * 0.08 * 0.1, 1e-9);
  EXPECT_EQ(l.pieces.size(), 2U);
  EXPECT_FALSE(l.convex);
}

TEST(ConvexPieces, FillTheSolidAndNothingElse) {
  const Shape u = make_shape("u", make_u());
  const auto pieces = find_convex_pieces(u.mesh, u.hull);
  ASSERT_EQ(pieces.size(), 3U);
  RandomStream random(3, 0, 0);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 point(random.uniform(-1.6, 1.6), random.uniform(-1.2, 1.2), random.uniform(-0.6, 0.6));
    const bool covered =
        std::ranges::any_of(pieces, [&](const Hull& piece) { return is_inside(piece, point); });
    EXPECT_EQ(covered, winding_number(u.mesh, point) == 1) << point.transpose();
    inside += covered;
  }
  EXPECT_GT(inside, 500);
}

TEST(ConvexPieces, OfACurvedConcaveSolidAreNone) {
  const Shape bunny = make_bunny_shape(0.2, 500);
  EXPECT_TRUE(find_convex_pieces(bunny.mesh, bunny.hull).empty());
  EXPECT_TRUE(bunny.pieces.empty());
}

TEST(ConvexPieces, GrowWithTheirShape) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)), large = scale_shape(l, 10.0);
  ASSERT_EQ(large.pieces.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(large.pieces[i].volume, 1e3 * l.pieces[i].volume, 1e-9);
    EXPECT_TRUE(large.pieces[i].center_of_mass_in_mesh.isApprox(10.0 * l.pieces[i].center_of_mass_in_mesh));
  }
}

}  // namespace
}  // namespace lodestone
