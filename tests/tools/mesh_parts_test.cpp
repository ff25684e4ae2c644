#include "tools/mesh_parts.h"

#include <gtest/gtest.h>

#include "reference/shape.h"

namespace lodestone {
namespace {

// Boxes of these sides (m) about these middles, in one mesh.
Mesh boxes(const std::vector<std::pair<double, Vec3>>& cubes) {
  Mesh all;
  for (const auto& [side, middle] : cubes) {
    const Mesh box = make_box(Vec3::Constant(side));
    const int first = int(all.vertices.size());
    for (const Vec3& vertex : box.vertices) all.vertices.push_back(vertex + middle);
    for (auto face : box.faces) {
      for (int k = 0; k < 3; ++k) face[std::size_t(k)] += first;
      all.faces.push_back(face);
    }
  }
  return all;
}

TEST(MeshParts, OneAndTwoApart) {
  EXPECT_EQ(find_mesh_parts(boxes({{1.0, {0, 0, 0}}})).parts, 1);
  const MeshParts apart = find_mesh_parts(boxes({{1.0, {0, 0, 0}}, {1.0, {3, 0, 0}}}));
  EXPECT_EQ(apart.parts, 2);
  EXPECT_EQ(apart.nested, 0);
  EXPECT_EQ(apart.overlapping, 0);
}

TEST(MeshParts, NestedIsInsideWholly) {
  const MeshParts nested = find_mesh_parts(boxes({{1.0, {0, 0, 0}}, {0.3, {0.1, 0, 0.05}}}));
  EXPECT_EQ(nested.parts, 2);
  EXPECT_EQ(nested.nested, 1);
  EXPECT_EQ(nested.overlapping, 0);
}

TEST(MeshParts, OverlappingIsInsidePartly) {
  const MeshParts both = find_mesh_parts(boxes({{1.0, {0, 0, 0}}, {1.0, {0.7, 0.6, 0.8}}, {0.2, {9, 0, 0}}}));
  EXPECT_EQ(both.parts, 3);
  EXPECT_EQ(both.nested, 0);
  EXPECT_EQ(both.overlapping, 2);
}

}  // namespace
}  // namespace lodestone
