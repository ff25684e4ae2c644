// The farthest vertex along a direction, against a look at all of them.
#include <gtest/gtest.h>

#include <limits>

#include "reference/hull/hull.h"
#include "reference/mesh/mesh.h"
#include "reference/random.h"

namespace lodestone {
namespace {

// Points on a sphere, a bulky or a flat cloud, or the corners of a box.
Hull draw_hull(std::uint32_t number) {
  RandomStream random(57, number, 0);
  std::vector<Vec3> points;
  const Vec3 sides(random.uniform(0.1, 2.0), random.uniform(0.1, 2.0),
                   number % 4 == 3 ? 1e-3 : random.uniform(0.1, 2.0));
  for (int i = 0; i < 6 + int(number) * 3; ++i) {
    const Vec3 direction = random.direction();
    points.emplace_back(sides.cwiseProduct(number % 2 ? direction : random.uniform(0.2, 1.0) * direction));
  }
  if (number % 5 == 0)
    for (int corner = 0; corner < 8; ++corner)
      points.emplace_back(
          sides.cwiseProduct(Vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)));
  return make_hull(points);
}

double greatest_height(const Hull& hull, const Vec3& direction) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Vec3& vertex : hull.vertices) greatest = std::max(greatest, vertex.dot(direction));
  return greatest;
}

TEST(FindSupport, IsTheFarthestOfAllVerticesWhereverItStarts) {
  for (std::uint32_t number = 0; number < 24; ++number) {
    const Hull hull = draw_hull(number);
    RandomStream random(58, number, 0);
    for (int i = 0; i < 100; ++i) {
      const Vec3 direction = random.uniform(0.1, 10.0) * random.direction();
      const double expected = greatest_height(hull, direction);
      const int start = int(random.uniform(0.0, double(hull.vertices.size())));
      const double found = hull.vertices[std::size_t(find_support(hull, direction, start))].dot(direction);
      EXPECT_NEAR(found, expected, 1e-11 * direction.norm()) << number << ' ' << i;
    }
  }
}

// Normal to faces, along edges: where several vertices are as far, whichever is found is as far as they.
TEST(FindSupport, TiesAreAsFarAsAny) {
  for (std::uint32_t number = 0; number < 12; ++number) {
    const Hull hull = draw_hull(number);
    for (int face = 0; face < int(hull.faces.size()); ++face) {
      const Vec3 normal = hull.face_normals[face];
      for (int start = 0; start < int(hull.vertices.size()); start += 3)
        EXPECT_NEAR(hull.vertices[std::size_t(find_support(hull, normal, start))].dot(normal),
                    hull.vertices[std::size_t(hull.faces[std::size_t(face)][0])].dot(normal), 1e-11);
    }
  }
}

TEST(FindSupport, OfTheOppositeDirectionIsTheOtherEnd) {
  const Hull hull = make_hull(make_box({1, 2, 3}).vertices);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 direction = Vec3::Unit(axis) + 0.1 * Vec3::Unit((axis + 1) % 3) + 0.01 * Vec3::Ones();
    const Vec3 there = hull.vertices[std::size_t(find_support(hull, direction))],
               back = hull.vertices[std::size_t(find_support(hull, -direction, 3))];
    EXPECT_EQ(there, -back);
  }
}

TEST(FindSupport, OfNoDirectionIsSomeVertex) {
  const Hull hull = draw_hull(7);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const SupportMap map(hull);
  for (const Vec3& direction :
       {Vec3(0, 0, 0), Vec3(nan, 0, 0), Vec3(nan, nan, nan), Vec3(inf, 0, 0), Vec3(-inf, inf, nan)}) {
    const int start = map.find_start(direction);
    ASSERT_TRUE(start >= 0 && start < int(hull.vertices.size()));
    const int found = find_support(hull, direction, start);
    EXPECT_TRUE(found >= 0 && found < int(hull.vertices.size()));
  }
}

// The start may be any vertex; the climb from there is exact. Finer maps start nearer.
TEST(SupportMap, ALookupAndAClimbAreExactForAnyFineness) {
  for (const int side : {1, 2, 7, 32}) {
    const Hull hull = draw_hull(21);
    const SupportMap map(hull, side);
    EXPECT_EQ(map.vertices().size(), std::size_t(6 * side * side));
    RandomStream random(59, std::uint32_t(side), 0);
    for (int i = 0; i < 300; ++i) {
      const Vec3 direction = random.uniform(1e-6, 1e6) * random.direction();
      const int found = find_support(hull, direction, map.find_start(direction));
      EXPECT_NEAR(hull.vertices[std::size_t(found)].dot(direction), greatest_height(hull, direction),
                  1e-11 * direction.norm());
    }
  }
}

TEST(SupportMap, CellsHoldTheFarthestVertexOfTheirMiddle) {
  const Hull hull = draw_hull(22);
  constexpr int kSide = 8;
  const SupportMap map(hull, kSide);
  for (int face = 0; face < 6; ++face)
    for (int u = 0; u < kSide; ++u)
      for (int v = 0; v < kSide; ++v) {
        Vec3 middle;
        const int axis = face / 2;
        middle[axis] = face % 2 ? -1.0 : 1.0;
        middle[(axis + 1) % 3] = (2 * u + 1.0) / kSide - 1.0;
        middle[(axis + 2) % 3] = (2 * v + 1.0) / kSide - 1.0;
        EXPECT_NEAR(hull.vertices[std::size_t(map.find_start(middle))].dot(middle),
                    greatest_height(hull, middle), 1e-11);
      }
}

TEST(SupportMap, WhatItMissesWithoutTheClimbShrinksWithItsCells) {
  const Hull hull = draw_hull(23);
  double before = 1e9;
  for (const int side : {2, 8, 32}) {
    const SupportMapError error = find_lookup_error(hull, SupportMap(hull, side));
    EXPECT_GE(error.mean, 0.0);
    EXPECT_LE(error.mean, error.greatest);
    EXPECT_LT(error.mean, 0.5 * before) << side;
    before = error.mean;
  }
  // A box has a vertex per octant, and cells of an even map never lie across two.
  const Hull box = make_hull(make_box({1, 2, 3}).vertices);
  EXPECT_NEAR(find_lookup_error(box, SupportMap(box, 2)).greatest, 0.0, 1e-12);
}

}  // namespace
}  // namespace lodestone
