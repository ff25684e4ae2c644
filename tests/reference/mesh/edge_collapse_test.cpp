#include "reference/mesh/edge_collapse.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "reference/mesh/mass_properties.h"
#include "reference/random.h"

namespace lodestone {
namespace {

/// Each edge once in each direction: closed, consistently oriented, without an edge of more faces.
bool is_closed(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& face : mesh.faces)
    for (int i = 0; i < 3; ++i) ++edges[{face[std::size_t(i)], face[std::size_t((i + 1) % 3)]}];
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return true;
}

/// V − E + F of the vertices that faces have: 2 for a sphere, 0 for a ring.
int euler_characteristic(const Mesh& mesh) {
  std::set<int> vertices;
  for (const auto& face : mesh.faces) vertices.insert(face.begin(), face.end());
  return int(vertices.size()) - int(mesh.faces.size()) / 2;  // E = 3 F / 2
}

Mesh make_ring(int around, int across) {
  Mesh ring;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across, r = 1.0 + 0.4 * std::cos(v);
      ring.vertices.emplace_back(r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
    }
  const auto at = [&](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      ring.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      ring.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return ring;
}

TEST(EdgeCollapse, ReachesTheCountAndStaysClosed) {
  const Mesh ball = make_sphere(1.0, 3);
  ASSERT_TRUE(is_closed(ball));
  for (const int faces : {640, 100, 20, 8}) {
    double error = -1.0;
    const Mesh less = collapse_edges(ball, faces, &error);
    EXPECT_LE(int(less.faces.size()), faces);
    EXPECT_GE(int(less.faces.size()), faces - 1);  // two go at a time
    EXPECT_TRUE(is_closed(less)) << faces;
    EXPECT_EQ(euler_characteristic(less), 2);
    EXPECT_GT(error, 0.0);
    EXPECT_GT(measure_mass_properties(less).volume, 0.0);
  }
}

TEST(EdgeCollapse, ARingKeepsItsHole) {
  const Mesh ring = make_ring(24, 12);
  ASSERT_TRUE(is_closed(ring));
  for (const int faces : {200, 60, 4}) {
    const Mesh less = collapse_edges(ring, faces);
    EXPECT_TRUE(is_closed(less)) << faces;
    EXPECT_EQ(euler_characteristic(less), 0) << faces;
  }
}

// A tetrahedron has no edge to spare; what is below the count is left as it is.
TEST(EdgeCollapse, WhatCannotBeLessIsLeft) {
  const Mesh ball = make_sphere(1.0, 2);
  const Mesh least = collapse_edges(ball, 0);
  EXPECT_GE(least.faces.size(), 4U);
  EXPECT_TRUE(is_closed(least));
  double error = -1.0;
  const Mesh same = collapse_edges(ball, 10'000, &error);
  EXPECT_EQ(same.faces, ball.faces);
  EXPECT_EQ(error, 0.0);
}

// Every vertex that is left is one of the first, at the same place.
TEST(EdgeCollapse, VerticesAreNotMoved) {
  const Mesh ball = make_sphere(0.7, 2), less = collapse_edges(ball, 60);
  ASSERT_EQ(less.vertices.size(), ball.vertices.size());
  for (std::size_t i = 0; i < ball.vertices.size(); ++i) EXPECT_EQ(less.vertices[i], ball.vertices[i]);
}

// The faces of a finely divided box are flat: what lies within them goes at no cost, and its solid stays.
TEST(EdgeCollapse, FlatFacesCostNothing) {
  Mesh box = make_box({1, 1, 1});
  for (int round = 0; round < 2; ++round) {  // each face into four, with edges shared
    Mesh finer{box.vertices, {}};
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, added] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, int(finer.vertices.size()));
      if (added)
        finer.vertices.emplace_back(0.5 * (box.vertices[std::size_t(a)] + box.vertices[std::size_t(b)]));
      return place->second;
    };
    for (const auto& [a, b, c] : box.faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.faces.insert(finer.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    box = finer;
  }
  ASSERT_EQ(box.faces.size(), 12U * 16);
  double error = -1.0;
  const Mesh less = collapse_edges(box, 12, &error);
  EXPECT_EQ(less.faces.size(), 12U);
  EXPECT_NEAR(error, 0.0, 1e-7);
  EXPECT_NEAR(measure_mass_properties(less).volume, 1.0, 1e-9);
}

TEST(EdgeCollapse, ErrorsScaleWithTheMesh) {
  const Mesh ball = make_sphere(1.0, 2);
  Mesh large = ball;
  for (Vec3& vertex : large.vertices) vertex *= 8.0;  // a power of two: the same to rounding
  double small_error = 0.0, large_error = 0.0;
  const Mesh a = collapse_edges(ball, 40, &small_error), b = collapse_edges(large, 40, &large_error);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_NEAR(large_error, 8.0 * small_error, 1e-9);
}

}  // namespace
}  // namespace lodestone
