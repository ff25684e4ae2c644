#include "lod/callers/geom_solids.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/random.h"

namespace lodestone {
namespace {

// Greatest n·x over the corners.
double support(const std::vector<Vec3>& corners, const Vec3& n) {
  double most = -1e9;
  for (const Vec3& corner : corners) most = std::max(most, n.dot(corner));
  return most;
}

// Off from the round shape by less than a thousandth of its radius on average, and by a hundredth at most.
void expect_round(const std::vector<Vec3>& corners, double radius, const auto& exact) {
  RandomStream random(1, 0, 0);
  double mean = 0.0;
  constexpr int kDirections = 2'000;
  for (int i = 0; i < kDirections; ++i) {
    const Vec3 n = random.direction();
    const double off = support(corners, n) - exact(n);
    EXPECT_LT(std::abs(off), 0.012 * radius);
    mean += off / kDirections;
  }
  EXPECT_LT(std::abs(mean), 1e-3 * radius);
}

TEST(GeomSolids, ACapsuleIsRoundAllOver) {
  const GeomShape capsule{.kind = GeomKind::capsule, .radius = 0.5, .length = 2.0};
  expect_round(corners_of(capsule), 0.5, [](const Vec3& n) { return 0.5 + std::abs(n.z()); });
  const GeomShape ball{.kind = GeomKind::sphere, .radius = 0.5};
  expect_round(corners_of(ball), 0.5, [](const Vec3&) { return 0.5; });
}

TEST(GeomSolids, ACylinderHasItsHeightAndIsRoundAboutZ) {
  const GeomShape cylinder{.kind = GeomKind::cylinder, .radius = 0.5, .length = 2.0};
  const std::vector<Vec3> corners = corners_of(cylinder);
  EXPECT_DOUBLE_EQ(support(corners, Vec3::UnitZ()), 1.0);
  EXPECT_DOUBLE_EQ(support(corners, -Vec3::UnitZ()), 1.0);
  double mean = 0.0;
  for (int i = 0; i < 1'000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 1'000;
    mean += support(corners, {std::cos(angle), std::sin(angle), 0}) / 1'000;
  }
  EXPECT_NEAR(mean, 0.5, 1e-3 * 0.5);
}

TEST(GeomSolids, BoxesAndConvexGeomsAreThemselves) {
  const std::vector<Vec3> box = corners_of({.kind = GeomKind::box, .sides = {1, 2, 3}});
  EXPECT_EQ(box.size(), 8U);
  EXPECT_DOUBLE_EQ(support(box, {1, 1, 1}), 3.0);
  const std::vector<Vec3> given = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(corners_of({.kind = GeomKind::convex, .vertices = given}), given);
  EXPECT_EQ(solids_of({.kind = GeomKind::convex, .vertices = given}).size(), 1U);
}

// ODE gives three vertices a face; those that coincide are one, and faces that were a line are gone.
TEST(GeomSolids, ATrimeshGetsItsCornersBack) {
  const Mesh box = make_box({1, 1, 1});
  GeomShape geom{.kind = GeomKind::trimesh};
  for (const auto& face : box.faces) {
    const int first = int(geom.vertices.size());
    for (const int corner : face) geom.vertices.push_back(box.vertices[std::size_t(corner)]);
    geom.faces.push_back({first, first + 1, first + 2});
  }
  geom.vertices.insert(geom.vertices.end(), {Vec3(9, 9, 9), Vec3(9, 9, 9), Vec3(8, 8, 8)});
  geom.faces.push_back({36, 37, 38});
  const Mesh mesh = mesh_of(geom);
  EXPECT_EQ(mesh.faces.size(), 12U);
  EXPECT_EQ(mesh.vertices.size(), 10U);   // the two of the face that is gone, too
  EXPECT_EQ(solids_of(geom).size(), 1U);  // it is convex
}

TEST(GeomSolids, OfWhatIsNoSolidThereIsNone) {
  for (const GeomKind kind : {GeomKind::plane, GeomKind::height_field, GeomKind::other})
    EXPECT_EQ(solids_of({.kind = kind}).size(), 0U);
  const std::vector<Vec3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_EQ(solids_of({.kind = GeomKind::convex, .vertices = flat}).size(), 0U);
  EXPECT_EQ(solids_of({.kind = GeomKind::trimesh}).size(), 0U);
}

}  // namespace
}  // namespace lodestone
