// What a hull has near its farthest point along a direction, against a look at all of its vertices.
#include "reference/hull/tip_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/random.h"

namespace lodestone {
namespace {

// Points on an ellipsoid about a centre that is not the origin.
Hull draw_round_hull(int points, std::uint32_t number) {
  RandomStream random(61, number, 0);
  const Vec3 sides(random.uniform(0.5, 2.0), random.uniform(0.5, 2.0), random.uniform(0.5, 2.0));
  std::vector<Vec3> all;
  for (int i = 0; i < points; ++i)
    all.emplace_back(sides.cwiseProduct(random.direction()) + Vec3(0.05, 0.0, 0.02));
  return make_hull(all);
}

double greatest_distance_of(const Hull& hull) {
  double radius = 0.0;
  for (const Vec3& v : hull.vertices) radius = std::max(radius, v.norm());
  return radius;
}

TEST(TipMap, HoldsAllThatLieNearTheFarthestInTheHullsOrder) {
  std::size_t listed = 0, asked = 0;
  for (std::uint32_t number = 0; number < 6; ++number) {
    const Hull hull = draw_round_hull(100 + 80 * int(number), number);
    const double radius = greatest_distance_of(hull);
    const TipMap tips(hull, radius);
    RandomStream random(62, number, 0);
    for (int i = 0; i < 500; ++i) {
      const Vec3 unit = random.direction(), direction = random.uniform(0.1, 10.0) * unit;
      const auto found = tips.find(direction);
      ASSERT_FALSE(found.empty());
      EXPECT_TRUE(std::ranges::is_sorted(found));
      const double farthest = hull.vertices[std::size_t(find_support(hull, unit))].dot(unit);
      for (std::size_t v = 0; v < hull.vertices.size(); ++v) {
        if (hull.vertices[v].dot(unit) <= farthest - TipMap::kDepth * radius) continue;
        EXPECT_TRUE(std::ranges::binary_search(found, std::uint16_t(v))) << number << ' ' << i << ' ' << v;
      }
      listed += found.size(), asked += hull.vertices.size();
    }
  }
  EXPECT_LT(double(listed), 0.15 * double(asked)) << "else it saves nothing";
}

// Where a loop over all is as quick, or most would be in every list.
TEST(TipMap, OfFewVerticesOrOfAFlatDiscOfManyItSaysNothing) {
  const Hull few = draw_round_hull(60, 9);
  EXPECT_TRUE(TipMap(few, greatest_distance_of(few)).find(Vec3::UnitX()).empty());
  std::vector<Vec3> disc;
  for (int i = 0; i < 500; ++i)
    disc.emplace_back(std::cos(0.01 * i * 1.2566), std::sin(0.01 * i * 1.2566), i % 2 ? 0.001 : -0.001);
  const Hull flat = make_hull(disc);
  const TipMap tips(flat, greatest_distance_of(flat));
  EXPECT_TRUE(tips.find(Vec3::UnitZ()).empty());
  EXPECT_FALSE(tips.find(Vec3::UnitX()).empty());
}

TEST(TipMap, NoDirectionReadsBeyondIt) {
  const Hull hull = draw_round_hull(200, 3);
  const TipMap tips(hull, greatest_distance_of(hull));
  for (const double bad : {0.0, std::numeric_limits<double>::quiet_NaN(), 1e300})
    for (const auto vertex : tips.find(Vec3(bad, bad, bad))) EXPECT_LT(vertex, hull.vertices.size());
}

}  // namespace
}  // namespace lodestone
