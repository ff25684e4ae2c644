#include "lod/ground/deep_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace lodestone {
namespace {

using ThreeCorners = DeepTriangles::Corners;

// Cells of a metre, in waves of a slope of up to 22°.
std::vector<ThreeCorners> wavy_cells(int across) {
  const auto at = [](int x, int y) { return Vec3(x, y, 0.3 * std::sin(1.3 * x) * std::cos(1.1 * y)); };
  std::vector<ThreeCorners> triangles;
  for (int y = 0; y < across; ++y)
    for (int x = 0; x < across; ++x) {
      triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return triangles;
}

Vec3 normal_to(const ThreeCorners& t) { return (t[1] - t[0]).cross(t[2] - t[0]).normalized(); }

// m: to what is solid down to `depth` below a triangle, as far beside it as above or below.
double distance_to(const ThreeCorners& t, double depth, const Vec3& point) {
  const Vec3 normal = normal_to(t);
  const double height = normal.dot(point - t[0]), off = std::max({0.0, height, -height - depth});
  const Vec3 foot = point - height * normal;
  double beside = 1e300;
  bool is_over = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 along = t[(i + 1) % 3] - t[i], from = foot - t[i];
    is_over = is_over && normal.cross(along).dot(from) >= 0.0;
    beside =
        std::min(beside, (from - std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0) * along).norm());
  }
  return std::hypot(off, is_over ? 0.0 : beside);
}

void expect_all_near(const std::vector<ThreeCorners>& triangles, double depth, const DeepTriangles& deep,
                     const Vec3& center, double reach, std::size_t most) {
  std::vector<int> found;
  deep.find_near(center, reach, 1000, found);
  EXPECT_LE(found.size(), most) << center.transpose();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const bool is_near = distance_to(triangles[i], depth, center) <= reach;
    EXPECT_LE(int(is_near), std::ranges::count(found, int(i) + 1000)) << i << " near " << center.transpose();
  }
}

TEST(DeepTriangles, AreFoundAboveTheSurfaceAndFarBelowIt) {
  const std::vector<ThreeCorners> triangles = wavy_cells(40);
  constexpr double kDeep = 6.0;
  const DeepTriangles one_way(triangles, kDeep, OneWay{.up = Vec3::UnitZ(), .least_cosine = 0.85}),
      any_way(triangles, kDeep, std::nullopt);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(5.0, 35.0), height(-8.0, 1.5);
  for (int i = 0; i < 100; ++i) {
    const Vec3 center(place(random), place(random), height(random));
    expect_all_near(triangles, kDeep, one_way, center, 0.4, 60);
    expect_all_near(triangles, kDeep, any_way, center, 0.4, 60);
  }
}

// Where their solids lean over the boxes around many more of them: they are told apart.
TEST(DeepTriangles, OverALandscapeFewAreNear) {
  const std::vector<ThreeCorners> triangles = wavy_cells(60);
  constexpr double kDeep = 14.0;
  const DeepTriangles deep(triangles, kDeep, OneWay{.up = Vec3::UnitZ(), .least_cosine = 0.85});
  for (int i = 0; i < 50; ++i) {
    const double x = 5.0 + i, y = 50.0 - 0.9 * i;
    const Vec3 center(x, y, 0.3 * std::sin(1.3 * x) * std::cos(1.1 * y) + 0.3);
    expect_all_near(triangles, kDeep, deep, center, 0.4, 12);
  }
}

TEST(DeepTriangles, AreFoundFarFromTheOrigin) {
  std::vector<ThreeCorners> triangles = wavy_cells(20);
  for (ThreeCorners& t : triangles)
    for (Vec3& corner : t) corner += Vec3(1e5, -2e5, 3e4);
  const DeepTriangles deep(triangles, 1.0, OneWay{.up = Vec3::UnitZ(), .least_cosine = 0.85});
  for (int i = 0; i < 50; ++i)
    expect_all_near(triangles, 1.0, deep, Vec3(1e5 + 2.0 + 0.3 * i, -2e5 + 5.0 + 0.2 * i, 3e4 + 0.02 * i),
                    0.3, 20);
}

}  // namespace
}  // namespace lodestone
