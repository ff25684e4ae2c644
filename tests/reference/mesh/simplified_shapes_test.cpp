#include "reference/mesh/simplified_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "reference/error.h"
#include "reference/mesh/edge_collapse.h"
#include "reference/mesh/inside.h"
#include "reference/mesh/mass_properties.h"
#include "reference/shape.h"

namespace lodestone {
namespace {

const Mesh& whole_bunny() {
  static const Mesh mesh = repair_mesh(load_mesh("/usr/share/glmark2/models/bunny.obj"), "bunny");
  return mesh;
}

void expect_closed(const Mesh& mesh) {
  MeshReport report;
  const Mesh repaired = repair_mesh(mesh, "simplified", &report);
  EXPECT_TRUE(report.closed()) << report.open_edges << " open, " << report.non_manifold_edges
                               << " non-manifold";
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(hash_of(repaired), hash_of(mesh));  // nothing to mend
}

double volume_of(const Mesh& mesh) { return measure_mass_properties(mesh).volume; }

TEST(Simplify, KeepsTheBunnyClosedAtEveryCount) {
  double previous_error = 0.0;
  for (int faces : {20'000, 4698, 1000, 194, 50}) {
    double error = 0.0;
    const Mesh simplified = simplify_mesh(whole_bunny(), faces, &error);
    EXPECT_EQ(int(simplified.faces.size()), faces);
    expect_closed(simplified);
    EXPECT_GT(error, previous_error);
    previous_error = error;
  }
  EXPECT_NEAR(volume_of(simplify_mesh(whole_bunny(), 4698)), volume_of(whole_bunny()),
              0.01 * volume_of(whole_bunny()));
}

TEST(Simplify, LeavesSmallMeshesAlone) {
  double error = 1.0;
  EXPECT_EQ(hash_of(simplify_mesh(make_box({1, 1, 1}), 12, &error)), hash_of(make_box({1, 1, 1})));
  EXPECT_EQ(error, 0.0);
}

TEST(Simplify, ReducesAGriddedSphereToAnyCount) {
  const Mesh sphere = make_sphere(1.0, 4);
  for (int faces : {4, 8, 100, 101, 1000}) {
    const Mesh simplified = simplify_mesh(sphere, faces);
    EXPECT_EQ(int(simplified.faces.size()), faces / 2 * 2);  // a closed mesh has an even number
    expect_closed(simplified);
  }
}

TEST(Simplify, TreatsScaledCopiesAlike) {
  const Mesh sphere = make_sphere(0.2, 3);
  const auto hash = make_shape("a", simplify_mesh(sphere, 200)).content_hash;
  for (double scale : {0.01, 0.3, 7.0}) {
    Mesh copy = sphere;
    for (Vec3& vertex : copy.vertices) vertex *= scale;
    EXPECT_EQ(make_shape("b", simplify_mesh(copy, 200)).content_hash, hash);
  }
}

TEST(Simplify, RefusesTooFewFaces) {
  EXPECT_THROW(simplify_mesh(make_sphere(1.0), 3), InputError);
  EXPECT_THROW(simplify_mesh(make_sphere(1.0), -1), InputError);
  EXPECT_THROW(simplify_mesh(
                   Mesh{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, std::vector<std::array<int, 3>>(9, {0, 1, 2})}, 4),
               InputError);
}

TEST(CollapseEdges, KeepsHandlesAndClosedness) {
  Mesh ring;  // a torus of 24 × 12 quads
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 12; ++j) {
      const double u = i * std::numbers::pi / 12.0, v = j * std::numbers::pi / 6.0,
                   r = 1.0 + 0.3 * std::cos(v);
      ring.vertices.emplace_back(r * std::cos(u), r * std::sin(u), 0.3 * std::sin(v));
      const int a = 12 * i + j, b = 12 * ((i + 1) % 24) + j, c = 12 * ((i + 1) % 24) + (j + 1) % 12,
                d = 12 * i + (j + 1) % 12;
      ring.faces.push_back({a, b, c});
      ring.faces.push_back({a, c, d});
    }
  const Mesh simplified = repair_mesh(collapse_edges(ring, 60), "ring");
  expect_closed(simplified);
  EXPECT_EQ(simplified.faces.size(), 60u);
  EXPECT_EQ(int(simplified.vertices.size()) - int(simplified.faces.size()) / 2,
            0);  // Euler characteristic 0: one handle
}

TEST(CollapseEdges, CostsNothingOnFlatFaces) {
  // A box of 4 × 4 × 4 cells a side falls to its 12 faces without an error.
  Mesh grid = make_box({1, 1, 1});
  for (int round = 0; round < 2; ++round) {
    Mesh finer;
    for (const auto& [a, b, c] : grid.faces) {
      const int n = int(finer.vertices.size());
      const Vec3 &p = grid.vertices[a], &q = grid.vertices[b], &r = grid.vertices[c];
      finer.vertices.insert(finer.vertices.end(), {p, q, r, 0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p)});
      finer.faces.insert(
          finer.faces.end(),
          {{n, n + 3, n + 5}, {n + 1, n + 4, n + 3}, {n + 2, n + 5, n + 4}, {n + 3, n + 4, n + 5}});
    }
    grid = repair_mesh(finer, "grid");
  }
  double error = 1.0;
  const Mesh simplified = repair_mesh(collapse_edges(grid, 12, &error), "box");
  EXPECT_EQ(simplified.faces.size(), 12u);
  EXPECT_NEAR(volume_of(simplified), 1.0, 1e-12);
  EXPECT_LE(error, 1e-7);
}

TEST(FitSpheres, CoverTheBunny) {
  const Shape bunny = make_bunny_shape(0.2);
  const auto spheres = fit_spheres(bunny.mesh);
  ASSERT_EQ(spheres.size(), 7u);
  const auto inside = find_inside_points(bunny.mesh, 0.2 / 40);
  int covered = 0;
  for (const Vec3& point : inside)
    covered += std::any_of(spheres.begin(), spheres.end(),
                           [&](const Sphere& s) { return (point - s.center).norm() < s.radius; });
  EXPECT_GT(covered, 0.7 * double(inside.size()));
  for (const Sphere& sphere : spheres) EXPECT_LT(sphere.center.norm() + sphere.radius, 1.3 * bunny.radius);
}

TEST(FitSpheres, GiveTheSameAgainAndScaleWithTheMesh) {
  const auto first = fit_spheres(make_l(0.3, 0.2, 0.05, 0.1)),
             again = fit_spheres(make_l(0.3, 0.2, 0.05, 0.1)),
             half = fit_spheres(make_l(0.15, 0.1, 0.025, 0.05));
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(first[i].center, again[i].center);
    EXPECT_EQ(first[i].radius, again[i].radius);
    EXPECT_NEAR(half[i].radius, 0.5 * first[i].radius, 1e-9);
  }
}

TEST(FitSpheres, MakeASphereOfASphere) {
  const auto spheres = fit_spheres(make_sphere(0.3), 1);
  EXPECT_LE(spheres[0].center.norm(), 1e-3);
  EXPECT_NEAR(spheres[0].radius, 0.3, 0.01);
}

TEST(FitSpheres, RefuseMeshesWithoutInside) {
  EXPECT_THROW(fit_spheres(Mesh{}), InputError);
  EXPECT_THROW(fit_spheres(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}), InputError);
}

}  // namespace
}  // namespace lodestone
