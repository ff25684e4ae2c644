#include "tools/compare/solid_meshes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"

namespace lodestone {
namespace {

using std::numbers::pi;

// Closed, turned outwards and welded already: nothing to mend.
double volume_of_sound(const Mesh& mesh) {
  MeshReport report;
  const Mesh repaired = repair_mesh(mesh, "solid", &report);
  EXPECT_TRUE(report.closed());
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.faces_flipped, 0);
  EXPECT_EQ(report.vertices_welded + report.degenerate_faces_dropped + report.duplicate_faces_dropped, 0);
  return measure_mass_properties(repaired).volume;
}

// Pappus: the area of the section, a polygon of n corners, n/2 r² sin(2π/n), on its way round; that of m
// prisms whose middles lie at R: less than 2πR by sin(2π/m)/(2π/m).
TEST(SolidMeshes, ATorusHasItsVolume) {
  const double ring = 0.3, tube = 0.1;
  const int around = 200, across = 200;
  const double area = 0.5 * across * tube * tube * std::sin(2 * pi / across),
               way = ring * around * std::sin(2 * pi / around);
  EXPECT_NEAR(volume_of_sound(make_torus(ring, tube, around, across)) / (area * way), 1.0, 1e-3);
  EXPECT_NEAR(volume_of_sound(make_torus(ring, tube, around, across)), 2 * pi * pi * ring * tube * tube,
              2e-5);
  const Mesh few = make_torus(ring, tube, 8, 5);
  EXPECT_EQ(few.vertices.size(), 40U);
  EXPECT_EQ(int(few.vertices.size()) - int(few.faces.size()) / 2, 0);  // Euler: V − E + F = 0, E = 3/2 F
}

TEST(SolidMeshes, PrismsHaveTheAreaOfTheirOutline) {
  const double hexagon[] = {1, 1, 1, 1, 1, 1}, star[] = {1, 0.5, 1, 0.5, 1, 0.5, 1, 0.5};
  EXPECT_NEAR(volume_of_sound(make_star_prism(hexagon, 0.5)), 0.5 * 1.5 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(volume_of_sound(make_star_prism(star, 2.0)), 2.0 * 8 * 0.5 * 0.5 * std::sin(pi / 4), 1e-12);
}

// h/3 (A₁ + A₂ + √(A₁A₂)).
TEST(SolidMeshes, AFrustumHasItsVolume) {
  const auto area = [](double radius) { return 2.0 * radius * radius; };  // of a square
  for (const double top : {0.3, 1.0})
    EXPECT_NEAR(volume_of_sound(make_frustum(4, 1.0, top, 1.5)),
                0.5 * (area(1.0) + area(top) + std::sqrt(area(1.0) * area(top))), 1e-12);
}

TEST(SolidMeshes, HullsHoldTheirPoints) {
  std::vector<Vec3> cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  cube.emplace_back(0.5, 0.5, 0.5);
  EXPECT_NEAR(volume_of_sound(make_hull_mesh(cube)), 1.0, 1e-12);
  const Mesh drawn = make_random_hull(40, {0.1, 0.2, 0.3}, 5);
  const double volume = volume_of_sound(drawn);
  EXPECT_LT(volume, 4.0 / 3.0 * pi * 0.1 * 0.2 * 0.3);
  EXPECT_GT(volume, 0.2 * 4.0 / 3.0 * pi * 0.1 * 0.2 * 0.3);
  EXPECT_EQ(hash_of(drawn), hash_of(make_random_hull(40, {0.1, 0.2, 0.3}, 5)));
  EXPECT_NE(hash_of(drawn), hash_of(make_random_hull(40, {0.1, 0.2, 0.3}, 6)));
}

// A U of two layers, one of which has a hole less.
TEST(SolidMeshes, CellsAreFilledWhereTheySaySo) {
  const CellSolid u{
      .x = {1, 2, 1}, .y = {1, 3}, .z = {0.5, 0.25}, .layers = {{"#.#", "###"}, {"...", "#.."}}};
  // Rows from the greatest y down: the first is 3 m high, the second 1 m.
  EXPECT_NEAR(volume_of_sound(make_cell_mesh(u)), 0.5 * (3 * (1 + 1) + 1 * (1 + 2 + 1)) + 0.25 * (1 * 1),
              1e-12);
}

}  // namespace
}  // namespace lodestone
