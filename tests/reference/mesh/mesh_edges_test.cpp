#include "reference/mesh/mesh_edges.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

std::vector<std::vector<EdgeUse>> edges_of(const Mesh& mesh) {
  std::vector<std::vector<EdgeUse>> edges;
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) { edges.emplace_back(uses.begin(), uses.end()); });
  return edges;
}

// Euler: V − E + F = 2, and each edge has a face on either side that run against each other.
TEST(MeshEdges, OfAClosedSolidEachHasTwoOpposedFaces) {
  for (const Mesh& mesh : {make_box({1, 2, 3}), make_sphere(1.0, 2), make_l(1, 1, 0.2, 0.2)}) {
    const auto edges = edges_of(mesh);
    EXPECT_EQ(int(mesh.vertices.size()) - int(edges.size()) + int(mesh.faces.size()), 2);
    for (const auto& uses : edges) {
      ASSERT_EQ(uses.size(), 2U);
      EXPECT_NE(uses[0].forward, uses[1].forward);
      EXPECT_NE(uses[0].face, uses[1].face);
    }
  }
}

TEST(MeshEdges, ComeInOrderOfTheirVerticesWithWhoRunsWhichWay) {
  const auto edges = edges_of({std::vector<Vec3>(4), {{2, 0, 1}, {2, 1, 3}, {1, 2, 3}}});
  ASSERT_EQ(edges.size(), 5U);
  const int expected[5][3] = {{0, 1, 1}, {0, 2, 1}, {1, 2, 3}, {1, 3, 2}, {2, 3, 2}};  // low, high, faces
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(edges[i][0].low, expected[i][0]);
    EXPECT_EQ(edges[i][0].high, expected[i][1]);
    EXPECT_EQ(int(edges[i].size()), expected[i][2]);
  }
  int forward = 0;
  for (const EdgeUse& use : edges[2]) forward += use.forward;
  EXPECT_EQ(forward, 2);  // faces 0 and 2 run from 1 to 2, face 1 back
  EXPECT_TRUE(edges[0][0].forward);
  EXPECT_FALSE(edges[1][0].forward);
}

TEST(MeshEdges, OfNoFacesThereAreNone) { EXPECT_TRUE(edges_of({}).empty()); }

}  // namespace
}  // namespace lodestone
