#include "reference/mesh/mesh_drop.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(MeshDrop, FacesThatNameAVertexTwice) {
  Mesh mesh = make_box({1, 1, 1});
  const auto box = mesh.faces;
  for (const std::array face : {std::array{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {2, 2, 2}})
    mesh.faces.insert(mesh.faces.begin() + 3, face);
  EXPECT_EQ(drop_degenerate_faces(mesh), 4);
  EXPECT_EQ(mesh.faces, box);
  EXPECT_EQ(drop_degenerate_faces(mesh), 0);
}

TEST(MeshDrop, OfTheSameCornersTheFirstStays) {
  Mesh mesh = make_box({1, 1, 1});
  const auto box = mesh.faces;
  const auto [a, b, c] = mesh.faces[4];
  mesh.faces.push_back({b, c, a});  // the same way round from another corner
  mesh.faces.push_back({a, b, c});
  EXPECT_EQ(drop_duplicate_faces(mesh), 2);
  EXPECT_EQ(mesh.faces, box);
}

TEST(MeshDrop, AFinIsDroppedOnBothSides) {
  Mesh mesh = make_box({1, 1, 1});
  const auto box = mesh.faces;
  mesh.vertices.emplace_back(2, 0, 0);
  mesh.faces.push_back({0, 1, 8});
  mesh.faces.push_back({1, 0, 8});
  EXPECT_EQ(drop_duplicate_faces(mesh), 2);
  EXPECT_EQ(mesh.faces, box);
}

TEST(MeshDrop, ASheetOfTwoSidesIsNotDroppedAway) {
  Mesh mesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_EQ(drop_duplicate_faces(mesh), 1);
  EXPECT_EQ(mesh.faces, (std::vector<std::array<int, 3>>{{0, 1, 2}}));
}

// A triangle whose third corner lies on the opposite side, beside the two that meet there.
TEST(MeshDrop, FlatFacesGoUnlessTheyFillASeam) {
  Mesh loose = make_box({1, 1, 1});
  const auto box = loose.faces;
  loose.vertices.emplace_back(0.5 * (loose.vertices[0] + loose.vertices[1]));
  loose.faces.push_back({0, 1, 8});
  EXPECT_EQ(drop_flat_faces(loose, 1e-6), 1);
  EXPECT_EQ(loose.faces, box);

  // One face divided at the middle of a side, its neighbour not: the sliver joins them.
  Mesh seam = make_box({1, 1, 1});
  const auto [a, b, c] = seam.faces[0];
  seam.vertices.emplace_back(0.5 * (seam.vertices[a] + seam.vertices[b]));
  seam.faces[0] = {a, 8, c};
  seam.faces.push_back({8, b, c});
  seam.faces.push_back({a, b, 8});
  const auto whole = seam.faces;
  EXPECT_EQ(drop_flat_faces(seam, 1e-6), 0);
  EXPECT_EQ(seam.faces, whole);
}

TEST(MeshDrop, FlatIsByTheHeightAboveTheLongestSide) {
  const auto with_height = [](double height) {
    Mesh mesh = make_box({1, 1, 1});
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(5, 0, 0), Vec3(7, 0, 0), Vec3(6, height, 0)});
    mesh.faces.push_back({8, 9, 10});
    return mesh;
  };
  Mesh lower = with_height(0.009), higher = with_height(0.011);
  EXPECT_EQ(drop_flat_faces(lower, 0.01), 1);
  EXPECT_EQ(drop_flat_faces(higher, 0.01), 0);
}

TEST(MeshDrop, VerticesOfNoFaceGoAndTheOthersKeepTheirOrder) {
  Mesh mesh = make_box({1, 1, 1});
  const Mesh box = mesh;
  mesh.vertices.insert(mesh.vertices.begin() + 2, Vec3(9, 9, 9));
  mesh.vertices.push_back(Vec3(8, 8, 8));
  for (auto& face : mesh.faces)
    for (int& corner : face) corner += corner >= 2;
  EXPECT_EQ(drop_unused_vertices(mesh), 2);
  EXPECT_EQ(mesh.vertices, box.vertices);
  EXPECT_EQ(mesh.faces, box.faces);
}

}  // namespace
}  // namespace lodestone
