// The cells against every pair tried: the same pairs, each once, for layers, piles, sparse clouds and mixed
// sizes.
#include "lod/broad_phase/cell_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

struct Balls {
  std::vector<double> x, y, z;
  std::vector<float> reach;
  void add(const Vec3& p, double r) {
    x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z()), reach.push_back(float(r));
  }
  BallSpan span() const { return {x, y, z, reach}; }
  Vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  double gap(std::size_t i, std::size_t j) const {
    return (at(i) - at(j)).norm() - double(reach[i]) - double(reach[j]);
  }
};

Balls cloud(int count, const Vec3& sides, double least, double most, const Vec3& from = Vec3::Zero()) {
  Balls balls;
  for (int i = 0; i < count; ++i) {
    RandomStream random(3, std::uint64_t(i), 0);
    const Vec3 p(random.uniform() * sides.x(), random.uniform() * sides.y(), random.uniform() * sides.z());
    balls.add(from + p, least * std::pow(most / least, random.uniform()));
  }
  return balls;
}

// Missing none that overlap, none twice, and none beyond the rounding of where balls are kept.
void expect_all_pairs(const Balls& balls, double rounding, Simd simd) {
  CellGrid grid(simd);
  grid.fill(balls.span());
  std::map<Pair, int> found;
  std::array<std::map<std::uint32_t, std::int64_t>, CellGrid::kColours> part_of;
  for (std::int64_t part = 0; part < grid.parts(); ++part) {
    BallPairs pairs;
    grid.find_pairs(part, pairs);
    for (std::int64_t i = 0; i < pairs.size(); ++i) {
      ++found[std::minmax(pairs.first(i), pairs.second(i))];
      for (const std::uint32_t ball : {pairs.first(i), pairs.second(i)}) {
        const auto [known, fresh] = part_of[std::size_t(grid.colour_of(part))].emplace(ball, part);
        EXPECT_TRUE(fresh || known->second == part) << "two parts of one colour share ball " << ball;
      }
    }
  }
  for (const auto& [pair, times] : found) {
    EXPECT_EQ(times, 1) << pair.first << ' ' << pair.second;
    EXPECT_LT(balls.gap(pair.first, pair.second), rounding) << pair.first << ' ' << pair.second;
  }
  std::size_t near = 0;
  for (std::uint32_t i = 0; i < balls.x.size(); ++i)
    for (std::uint32_t j = i + 1; j < balls.x.size(); ++j)
      if (balls.gap(i, j) < 0.0) {
        ++near;
        EXPECT_TRUE(found.contains({i, j})) << i << ' ' << j;
      }
  EXPECT_GT(near, 0u);
  std::set<std::uint32_t> every(grid.order().begin(), grid.order().end());
  EXPECT_EQ(every.size(), balls.x.size());
}

void expect_all_pairs(const Balls& balls, double rounding = 1e-3) {
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512})
    if (simd <= find_simd()) expect_all_pairs(balls, rounding, simd);  // others this processor lacks
}

TEST(CellGrid, FewBalls) { expect_all_pairs(cloud(12, {1, 1, 1}, 0.2, 0.2)); }
TEST(CellGrid, BallsThatReachNowhere) {
  Balls balls = cloud(200, {1, 1, 1}, 0.1, 0.1);
  balls.reach.assign(balls.reach.size(), 0.0f);
  CellGrid grid;
  grid.fill(balls.span());
  BallPairs pairs;
  for (std::int64_t part = 0; part < grid.parts(); ++part) grid.find_pairs(part, pairs);
  EXPECT_EQ(pairs.size(), 0);
  balls.reach[7] = 0.3f;
  expect_all_pairs(balls);
}
TEST(CellGrid, ThinLayer) { expect_all_pairs(cloud(1500, {12, 12, 0.3}, 0.1, 0.2)); }
TEST(CellGrid, Pile) { expect_all_pairs(cloud(1500, {3, 3, 4}, 0.1, 0.15)); }
TEST(CellGrid, LongRow) { expect_all_pairs(cloud(800, {0.2, 150, 0.2}, 0.1, 0.1)); }
TEST(CellGrid, SparseCloud) { expect_all_pairs(cloud(2000, {60, 50, 40}, 0.5, 1.0)); }
TEST(CellGrid, FarFromTheOrigin) { expect_all_pairs(cloud(1000, {4, 4, 2}, 0.1, 0.2, {1e4, -1e4, 1e4})); }
TEST(CellGrid, MixedSizes) { expect_all_pairs(cloud(1200, {10, 10, 10}, 0.01, 2.0)); }

TEST(CellGrid, TwoCloudsFarApart) {
  Balls balls = cloud(700, {3, 3, 3}, 0.1, 0.1);
  const Balls other = cloud(700, {3, 3, 3}, 0.1, 0.1, {1e4, 5e3, -8e3});
  for (std::size_t i = 0; i < other.x.size(); ++i) balls.add(other.at(i), double(other.reach[i]));
  expect_all_pairs(balls, 0.02);
}

TEST(CellGrid, PebblesAmongBoulders) {
  Balls balls = cloud(1500, {30, 30, 0.5}, 0.01, 0.012);
  for (int i = 0; i < 6; ++i) balls.add({5.0 * i, 20.0 - 3.0 * i, 2.0}, 5.0);
  expect_all_pairs(balls);
}

Balls layer_with_strays(int side) {
  Balls balls = cloud(side * side, {0.2 * side, 0.2 * side, 0.1}, 0.1, 0.1);
  for (const Vec3& far : {Vec3(3e5, -1e5, 2e4), Vec3(-2e4, 1e3, 4e5), Vec3(10, 2e5, -1e5), Vec3(5, 5, -1e3)})
    balls.add(far, 0.1);
  return balls;
}

TEST(CellGrid, StraysFarFromALayer) {
  expect_all_pairs(layer_with_strays(40));
  Balls mixed = layer_with_strays(30);
  for (std::size_t i = 0; i < mixed.x.size(); i += 90) mixed.reach[i] = 2.0f;
  expect_all_pairs(mixed);
}

// Balls that flew off make no cells so coarse that the layer's share them.
TEST(CellGrid, StraysCostTheLayerNothing) {
  const auto find_fill = [](const Balls& balls) {
    CellGrid grid;
    grid.fill(balls.span());
    return double(balls.x.size()) / double(grid.used_cells());
  };
  const Balls strays = layer_with_strays(100), alone = cloud(10'000, {20, 20, 0.1}, 0.1, 0.1);
  EXPECT_LT(find_fill(strays), 1.2 * find_fill(alone));
}

TEST(CellGrid, NearAPlaceAreAllThatReachIt) {
  for (const Balls& balls : {cloud(1000, {6, 6, 0.4}, 0.1, 0.2), cloud(1000, {80, 80, 80}, 0.3, 3.0)}) {
    CellGrid grid;
    grid.fill(balls.span());
    for (const Vec3& center : {Vec3(2, 3, 0.1), Vec3(-1, 0, 0), Vec3(40, 41, 39), Vec3(500, 0, 0)})
      for (const double reach : {0.1, 2.0, 30.0}) {
        std::set<std::uint32_t> found;
        grid.find_near(center, reach, [&](std::uint32_t ball) { EXPECT_TRUE(found.insert(ball).second); });
        for (std::uint32_t i = 0; i < balls.x.size(); ++i) {
          const bool reaches = (balls.at(i) - center).norm() < reach + double(balls.reach[i]);
          EXPECT_TRUE(!reaches || found.contains(i)) << i;
        }
      }
  }
}

}  // namespace
}  // namespace lodestone
