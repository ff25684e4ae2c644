#include "reference/mesh/mesh_weld.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodestone {
namespace {

// Each face with corners of its own, as STL files have them.
Mesh torn(const Mesh& mesh) {
  Mesh copy;
  for (const auto& face : mesh.faces) {
    const int first = int(copy.vertices.size());
    for (const int corner : face) copy.vertices.push_back(mesh.vertices[corner]);
    copy.faces.push_back({first, first + 1, first + 2});
  }
  return copy;
}

TEST(MeshWeld, FacesShareTheFirstOfEachPlace) {
  const Mesh box = make_box({1, 2, 3});
  Mesh mesh = torn(box);
  EXPECT_EQ(weld_vertices(mesh, 1e-9), 36 - 8);
  for (std::size_t f = 0; f < box.faces.size(); ++f)
    for (int corner = 0; corner < 3; ++corner) {
      const int index = mesh.faces[f][corner];
      EXPECT_EQ(mesh.vertices[index], box.vertices[box.faces[f][corner]]);
      for (int before = 0; before < index; ++before) EXPECT_NE(mesh.vertices[before], mesh.vertices[index]);
    }
}

TEST(MeshWeld, JoinsUpToTheDistanceWhicheverCellsTheyLieIn) {
  for (const double gap : {0.0099, 0.0101})
    for (const double start : {0.0, 0.013, 0.0199, 0.02, -0.005}) {  // cells are .02 wide
      Mesh mesh{{Vec3(-1, 0, 0), Vec3(start, 0, 0), Vec3(start + gap, 0, 0)}, {{0, 1, 2}}};
      EXPECT_EQ(weld_vertices(mesh, 0.01), gap < 0.01 ? 1 : 0) << start;
      EXPECT_EQ(mesh.faces[0][2], gap < 0.01 ? 1 : 2) << start;
    }
}

TEST(MeshWeld, DiagonalNeighboursAreMeasuredByTheirDistance) {
  Mesh mesh{{Vec3(0, 0, 0), Vec3(0.008, 0.008, 0), Vec3(0.004, 0.004, 0.004)}, {{0, 1, 2}}};
  EXPECT_EQ(weld_vertices(mesh, 0.01), 1);  // .0113 and .0069 from the first
  EXPECT_EQ(mesh.faces[0], (std::array{0, 1, 0}));
}

TEST(MeshWeld, ARowDoesNotCollapseIntoOne) {
  Mesh mesh;
  for (int i = 0; i < 9; ++i) mesh.vertices.emplace_back(0.006 * i, 0, 0);
  mesh.faces = {{0, 1, 2}, {6, 7, 8}};
  // To the first within .01 that was kept: 0 0 2 2 4 4 …
  EXPECT_EQ(weld_vertices(mesh, 0.01), 4);
  EXPECT_EQ(mesh.faces[0], (std::array{0, 0, 2}));
  EXPECT_EQ(mesh.faces[1], (std::array{6, 6, 8}));
}

}  // namespace
}  // namespace lodestone
