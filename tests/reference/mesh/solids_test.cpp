#include <gtest/gtest.h>

#include <limits>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"

namespace lodestone {
namespace {

Eigen::AlignedBox3d bounds_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

void expect_sound_solid(const Mesh& mesh, const Vec3& sides, double volume) {
  MeshReport report;
  const Mesh repaired = repair_mesh(mesh, "solid", &report);
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.faces_flipped + report.vertices_welded + report.degenerate_faces_dropped, 0);
  EXPECT_EQ(hash_of(repaired), hash_of(mesh));  // nothing to mend
  EXPECT_LE((bounds_of(mesh).sizes() - sides).cwiseAbs().maxCoeff(), 1e-12 * sides.maxCoeff());
  EXPECT_LE(bounds_of(mesh).center().norm(), 1e-12 * sides.maxCoeff());
  EXPECT_NEAR(measure_mass_properties(mesh).volume, volume, 1e-12 * volume);
}

TEST(Solids, AreClosedOutwardAndCentred) {
  expect_sound_solid(make_box({0.2, 0.3, 0.4}), {0.2, 0.3, 0.4}, 0.024);
  expect_sound_solid(make_box({1, 1, 1e-4}), {1, 1, 1e-4}, 1e-4);
  expect_sound_solid(make_l(0.3, 0.2, 0.05, 0.1), {0.3, 0.2, 0.1}, (0.3 + 0.2 - 0.05) * 0.05 * 0.1);
  expect_sound_solid(make_needle(1.0, 0.01), {0.02, 0.01 * std::sqrt(3.0), 1.0}, 1.5 * std::sqrt(3.0) * 1e-4);
  expect_sound_solid(make_needle(1.0, 1e-4), {2e-4, 1e-4 * std::sqrt(3.0), 1.0}, 1.5 * std::sqrt(3.0) * 1e-8);
}

TEST(Solids, OfLReachAlongTheirLegs) {
  // Leg A along x and leg B along y meet at the corner (−x, −y); opposite it nothing.
  const Mesh mesh = make_l(0.3, 0.2, 0.05, 0.1);
  double top_at_right = -1.0;
  for (const Vec3& v : mesh.vertices)
    if (v.x() > 0.1) top_at_right = std::max(top_at_right, v.y());
  EXPECT_NEAR(top_at_right, -0.1 + 0.05, 1e-15);
}

TEST(Solids, OfSpheresLieOnTheSphere) {
  for (int subdivisions = 0; subdivisions <= 4; ++subdivisions) {
    const Mesh mesh = make_sphere(0.3, subdivisions);
    EXPECT_EQ(mesh.faces.size(), 20u << (2 * subdivisions));
    MeshReport report;
    repair_mesh(mesh, "sphere", &report);
    EXPECT_TRUE(report.closed());
    EXPECT_EQ(report.faces_flipped, 0);
    for (const Vec3& vertex : mesh.vertices) EXPECT_NEAR(vertex.norm(), 0.3, 1e-15);
  }
}

TEST(Solids, RefuseImpossibleLengths) {
  for (double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(make_box({1, bad, 1}), InputError);
    EXPECT_THROW(make_sphere(bad), InputError);
    EXPECT_THROW(make_l(1, 1, bad, 1), InputError);
    EXPECT_THROW(make_needle(1, bad), InputError);
  }
  EXPECT_THROW(make_l(0.3, 0.2, 0.2, 0.1), InputError);  // a leg as wide as it is long is no L
}

TEST(ScaleToSize, SetsTheLongestSide) {
  EXPECT_NEAR(bounds_of(scale_to_size(make_box({0.2, 0.3, 0.4}), 2.0)).sizes().x(), 1.0, 1e-15);
  EXPECT_THROW(scale_to_size(make_box({1, 1, 1}), 0.0), InputError);
  EXPECT_THROW(scale_to_size(make_box({1, 1, 1}), std::nan("")), InputError);
  EXPECT_THROW(scale_to_size(Mesh{}, 1.0), InputError);
  EXPECT_THROW(scale_to_size(Mesh{{{1, 1, 1}, {1, 1, 1}}, {}}, 1.0), InputError);
}

}  // namespace
}  // namespace lodestone
