#include "tools/compare/unseen_shapes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "tools/compare/solid_meshes.h"

namespace lodestone {
namespace {

double volume_of(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.faces)
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
  return sum;
}

TEST(UnseenShapes, AreClosedInOnePieceAndOrientedAsMade) {
  std::set<std::string_view> names;
  for (const UnseenShape& shape : unseen_shapes()) {
    EXPECT_TRUE(names.insert(shape.name).second) << shape.name;
    MeshReport report;
    const Mesh mesh = shape.mesh();
    repair_mesh(mesh, std::string(shape.name), &report);
    EXPECT_TRUE(report.closed()) << shape.name;
    EXPECT_EQ(report.components, 1) << shape.name;
    EXPECT_EQ(report.faces_flipped, 0) << shape.name;
    EXPECT_EQ(report.degenerate_faces_dropped + report.duplicate_faces_dropped + report.vertices_welded, 0)
        << shape.name;
    EXPECT_GT(volume_of(mesh), 0.0) << shape.name;
  }
  EXPECT_GE(names.size(), 12U);
}

TEST(UnseenShapes, HaveTheSizeOfWhatTheUsualDropsAreMeantFor) {
  for (const UnseenShape& shape : unseen_shapes())
    EXPECT_NEAR(make_unseen_shape(shape.name)->size, 0.3, 1e-12) << shape.name;
}

TEST(SolidMeshes, HaveTheVolumesOfTheirSolids) {
  constexpr double kPi = std::numbers::pi;
  EXPECT_NEAR(volume_of(make_torus(1.0, 0.3, 128, 64)), 2.0 * kPi * kPi * 0.09,
              0.005 * 2.0 * kPi * kPi * 0.09);
  const std::vector<double> hexagon(6, 1.0);
  EXPECT_NEAR(volume_of(make_star_prism(hexagon, 2.0)), 3.0 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(volume_of(make_frustum(4, std::sqrt(2.0), std::sqrt(2.0), 3.0)), 12.0, 1e-12);
  EXPECT_NEAR(volume_of(make_cell_mesh(
                  {.x = {1, 2}, .y = {1, 3}, .z = {1, 1}, .layers = {{"##", "#."}, {"#.", ".."}}})),
              13.0, 1e-12);
}

}  // namespace
}  // namespace lodestone
