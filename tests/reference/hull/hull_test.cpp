#include "reference/hull/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <thread>

#include "reference/error.h"
#include "reference/random.h"
#include "reference/shape.h"

namespace lodestone::hull_test {
namespace {

std::vector<Vec3> random_points(int count, std::uint64_t seed) {
  RandomStream random(seed, 0, 0);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(random.direction() * random.uniform(0.5, 1.0));
  return points;
}

double greatest_height(std::span<const Vec3> points, const Vec3& direction) {
  double greatest = -1e300;
  for (const Vec3& point : points) greatest = std::max(greatest, point.dot(direction));
  return greatest;
}

/// Checks `trials` directions against all points: from the map's start, and from an arbitrary vertex.
void expect_exact_support(const Hull& hull, std::span<const Vec3> points, int trials) {
  const SupportMap map(hull);
  RandomStream random(7, 0, 0);
  double size = greatest_height(points, Vec3::UnitX()) + greatest_height(points, -Vec3::UnitX());
  double worst = 0.0;
  for (int i = 0; i < trials; ++i) {
    const Vec3 direction = random.direction();
    const double truth = greatest_height(points, direction);
    const int far_start = int(random.uniform() * double(hull.vertices.size()));
    for (int start : {map.find_start(direction), far_start})
      worst = std::max(worst,
                       std::abs(truth - hull.vertices[find_support(hull, direction, start)].dot(direction)));
  }
  EXPECT_LE(worst, 1e-12 * size);
}

/// Closed, Euler characteristic 2, counter-clockwise from outside, no vertex above any face, graph symmetric.
void expect_sound(const Hull& hull) {
  std::map<std::pair<int, int>, int> directed;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& vertex : hull.vertices) middle += vertex / double(hull.vertices.size());
  double size = 0.0;
  for (const Vec3& vertex : hull.vertices) size = std::max(size, 2.0 * (vertex - middle).norm());
  for (const auto& face : hull.faces) {
    for (int i = 0; i < 3; ++i) ++directed[{face[i], face[(i + 1) % 3]}];
    const Vec3 a = hull.vertices[face[0]],
               cross = (hull.vertices[face[1]] - a).cross(hull.vertices[face[2]] - a);
    EXPECT_LT(cross.dot(middle - a), 0.0);
    for (const Vec3& vertex : hull.vertices) EXPECT_LE(cross.normalized().dot(vertex - a), 1e-10 * size);
  }
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(directed.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), directed.size() / 2 + 2);
  EXPECT_EQ(hull.neighbor.size(), directed.size());
  for (int i = 0; i < int(hull.vertices.size()); ++i)
    for (int j : hull.neighbors(i)) EXPECT_TRUE(directed.contains({i, j}));
}

TEST(Hull, OfABoxHasItsEightCorners) {
  const Hull hull = make_hull(make_box({0.2, 0.3, 0.4}).vertices);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 12u);
  expect_sound(hull);
  expect_exact_support(hull, hull.vertices, 100'000);
}

TEST(Hull, ClimbsPastAxisAlignedTies) {
  const Hull hull = make_hull(make_box({0.2, 0.3, 0.4}).vertices);
  const SupportMap map(hull);
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {-1.0, 1.0}) {
      const Vec3 direction = sign * Vec3::Unit(axis);
      for (int start = 0; start < 8; ++start)
        EXPECT_EQ(hull.vertices[find_support(hull, direction, start)].dot(direction),
                  greatest_height(hull.vertices, direction));
    }
}

TEST(Hull, OfAPrismIsThatOfItsCorners) {
  for (const std::array<double, 3>& depth :
       {std::array{0.3, 0.3, 0.3}, std::array{1e-3, 1e-3, 1e-3}, std::array{0.3, 1e-3, 0.1}}) {
    const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(1, 0.1, 0.2), Vec3(0.2, 0.9, -0.1)};
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    const Hull prism = make_prism_hull(corners, {-depth[0] * normal, -depth[1] * normal, -depth[2] * normal}),
               found = make_hull(prism.vertices);
    ASSERT_EQ(prism.vertices.size(), 6u);
    EXPECT_EQ(prism.vertices, found.vertices);
    EXPECT_EQ(prism.faces.size(), found.faces.size());
    EXPECT_EQ(prism.lanes.x, found.lanes.x);
    for (const Vec3& n : prism.face_normals)
      EXPECT_TRUE(
          std::ranges::any_of(found.face_normals, [&](const Vec3& m) { return (m - n).norm() < 1e-12; }));
    expect_sound(prism);
    expect_exact_support(prism, prism.vertices, 1000);
  }
}

TEST(Hull, LeavesOutPointsOnFacesAndEdges) {
  // A grid of points over a tilted box: all but the corners lie on faces, on edges or inside, up to rounding.
  const Quat tilt(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  std::vector<Vec3> points;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j)
      for (int k = 0; k <= 8; ++k) points.push_back(Vec3(5, 6, 7) + tilt * Vec3(0.1 * i, 0.2 * j, 0.3 * k));
  const Hull hull = make_hull(points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  expect_sound(hull);
  expect_exact_support(hull, points, 1000);
}

TEST(Hull, KeepsEachOfNearlyEqualCornersOnce) {
  std::vector<Vec3> points = make_box({1, 1, 1}).vertices;
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 5; ++k) points.push_back(points[i] + 1e-13 * random.direction());
  const Hull hull = make_hull(points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  expect_sound(hull);
}

TEST(Hull, OfRandomPoints) {
  for (int count : {4, 5, 20, 100, 1000}) {
    const auto points = random_points(count, count);
    const Hull hull = make_hull(points);
    expect_sound(hull);
    expect_exact_support(hull, points, 10'000);
  }
}

TEST(Hull, OfTheBunny) {
  const Shape bunny = make_bunny_shape(0.2);
  EXPECT_GT(bunny.hull.vertices.size(), 250u);
  expect_sound(bunny.hull);
  expect_exact_support(bunny.hull, bunny.hull.vertices, 100'000);
  expect_exact_support(bunny.hull, bunny.mesh.vertices, 2'000);
}

TEST(Hull, OfSpheresPlatesAndNeedles) {
  for (const Mesh& mesh : {make_sphere(0.1), make_sphere(0.1, 4), make_box({1, 1, 1e-4}),
                           make_needle(1, 1e-4), make_l(0.3, 0.2, 0.05, 0.1)}) {
    const Hull hull = make_hull(mesh.vertices);
    expect_sound(hull);
    expect_exact_support(hull, mesh.vertices, 1000);
  }
  EXPECT_EQ(make_hull(make_sphere(0.1).vertices).vertices.size(), 642u);
  EXPECT_EQ(make_hull(make_l(0.3, 0.2, 0.05, 0.1).vertices).vertices.size(), 10u);
}

TEST(Hull, RefusesFlatAndFewPointsInSilence) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  EXPECT_THROW(make_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
  EXPECT_THROW(make_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}}),
               InputError);
  EXPECT_THROW(make_hull(std::vector<Vec3>(10, Vec3(1, 2, 3))), InputError);
  EXPECT_THROW(make_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}),
               InputError);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(Hull, IsTheSameFromSeveralThreadsAtOnce) {
  const auto points = random_points(2000, 9);
  const Hull expected = make_hull(points);
  std::vector<std::thread> threads;
  std::vector<int> same(4, 0);
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) same[t] += make_hull(points).vertices == expected.vertices;
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(same, std::vector<int>(4, 10));
}

TEST(SupportMap, StartsAtOrBesideTheFarthestVertex) {
  const Shape bunny = make_bunny_shape(0.2);
  const SupportMap map(bunny.hull);
  EXPECT_EQ(map.vertices().size(), 6u * 32 * 32);
  RandomStream random(11, 0, 0);
  int exact = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 direction = random.direction();
    const int start = map.find_start(direction);
    exact += find_support(bunny.hull, direction, start) == start;
  }
  EXPECT_GT(exact, 7'000);
}

// A cube's nearest vertex is wrong only in cells that a plane of symmetry cuts, and these planes run between
// cells.
TEST(SupportMap, LookupErrorIsThatOfTheCellsThatSeveralVerticesShare) {
  const Hull cube = make_hull(make_box({1, 1, 1}).vertices);
  EXPECT_EQ(find_lookup_error(cube, SupportMap(cube)).greatest, 0.0);
  const Shape bunny = make_bunny_shape(0.2);
  const SupportMapError fine = find_lookup_error(bunny.hull, SupportMap(bunny.hull)),
                        coarse = find_lookup_error(bunny.hull, SupportMap(bunny.hull, 4));
  EXPECT_GT(fine.mean, 0.0);
  EXPECT_LT(fine.mean, 1e-3 * bunny.radius);
  EXPECT_GT(coarse.mean, 5.0 * fine.mean);
  EXPECT_GE(coarse.greatest, coarse.mean);
}

TEST(SupportMap, SurvivesDirectionsThatPointNowhere) {
  const Hull hull = make_hull(make_box({1, 1, 1}).vertices);
  const SupportMap map(hull);
  for (double bad : {0.0, std::nan(""), HUGE_VAL}) {
    const int vertex = find_support(hull, Vec3::Constant(bad), map.find_start(Vec3::Constant(bad)));
    EXPECT_TRUE(vertex >= 0 && vertex < 8);
  }
}

}  // namespace
}  // namespace lodestone::hull_test
