// Pairs of balls in cells, against a look at all pairs, where cells are likely to go wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "lod/broad_phase/cell_grid.h"
#include "reference/random.h"

namespace lodestone {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

struct Layout {
  std::vector<double> x, y, z;
  std::vector<float> reach;
  void add(const Vec3& at, double r) {
    x.push_back(at.x()), y.push_back(at.y()), z.push_back(at.z()), reach.push_back(float(r));
  }
  BallSpan span() const { return {x, y, z, reach}; }
  /// Of those that overlap by more than rounding, or than touch within it.
  Pairs that_meet(double slack) const {
    Pairs pairs;
    for (std::uint32_t a = 0; a < x.size(); ++a)
      for (std::uint32_t b = a + 1; b < x.size(); ++b) {
        const double apart = (Vec3(x[a], y[a], z[a]) - Vec3(x[b], y[b], z[b])).norm();
        if (apart < double(reach[a]) + double(reach[b]) + slack) pairs.insert({a, b});
      }
    return pairs;
  }
};

void expect_all_pairs(const Layout& layout, Simd simd, double rounding) {
  CellGrid cells(simd);
  cells.fill(layout.span());
  BallPairs found;
  for (std::int64_t part = 0; part < cells.parts(); ++part) cells.find_pairs(part, found);
  Pairs pairs;
  for (std::int64_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(pairs.insert(std::minmax({found.first(i), found.second(i)})).second) << "twice";
  for (const auto& pair : layout.that_meet(-rounding)) EXPECT_TRUE(pairs.contains(pair)) << pair.first;
  const Pairs possible = layout.that_meet(rounding);
  for (const auto& pair : pairs) EXPECT_TRUE(possible.contains(pair)) << pair.first << ' ' << pair.second;
}

Layout scattered(std::uint32_t seed, int count, const Vec3& half, double least, double most,
                 const Vec3& middle = Vec3::Zero()) {
  RandomStream random(19, seed, 0);
  Layout layout;
  for (int i = 0; i < count; ++i) {
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1), c = random.uniform(-1, 1);
    layout.add(middle + half.cwiseProduct(Vec3(a, b, c)), random.uniform(least, most));
  }
  return layout;
}

TEST(CellPairs, InCloudsLayersAndLines) {
  const Vec3 halves[] = {{3, 3, 3}, {10, 10, 0.01}, {40, 0.01, 0.01}, {0.01, 20, 1}, {1, 0.01, 30}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    expect_all_pairs(scattered(i, 250, halves[i], 0.2, 0.4), find_simd(), 1e-4);
    expect_all_pairs(scattered(i, 250, halves[i], 0.2, 0.4), Simd::portable, 1e-4);
  }
}

TEST(CellPairs, OfManySizes) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    Layout layout = scattered(seed, 200, {6, 6, 6}, 0.1, 0.2);
    const Layout larger = scattered(seed + 10, 20, {6, 6, 6}, 1.0, 2.0),
                 giant = scattered(3, 1, {1, 1, 1}, 5, 5);
    for (const Layout* more : {&larger, &giant})
      for (std::size_t i = 0; i < more->x.size(); ++i)
        layout.add({more->x[i], more->y[i], more->z[i]}, double(more->reach[i]));
    expect_all_pairs(layout, find_simd(), 1e-4);
  }
}

// Two crowds very far apart: the cells must not grow with the distance.
TEST(CellPairs, OfCrowdsFarApart) {
  Layout layout = scattered(1, 120, {2, 2, 2}, 0.2, 0.4);
  const Layout away = scattered(2, 120, {2, 2, 2}, 0.2, 0.4, {5000, -3000, 0});
  for (std::size_t i = 0; i < away.x.size(); ++i)
    layout.add({away.x[i], away.y[i], away.z[i]}, double(away.reach[i]));
  layout.add({1e7, 0, 0}, 0.3);
  expect_all_pairs(layout, find_simd(), 0.01);
}

TEST(CellPairs, FarFromTheOrigin) {
  expect_all_pairs(scattered(5, 200, {3, 3, 3}, 0.2, 0.4, {1e6, -2e6, 3e5}), find_simd(), 1e-4);
}

// On the edges of cells, all at one place, one or none.
TEST(CellPairs, OfGridsStacksAndFew) {
  Layout grid;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) grid.add(0.5 * Vec3(i, j, k), 0.2500001);
  expect_all_pairs(grid, find_simd(), 1e-5);
  Layout at_one_place;
  for (int i = 0; i < 40; ++i) at_one_place.add({1, 2, 3}, 0.1);
  expect_all_pairs(at_one_place, find_simd(), 1e-6);
  for (const int count : {0, 1, 2, 3})
    expect_all_pairs(scattered(7, count, {0.1, 0.1, 0.1}, 0.2, 0.3), find_simd(), 1e-5);
}

// However many share the work, and with the same bits at each width.
TEST(CellPairs, DoNotHangOnWidthOrShares) {
  const Layout layout = scattered(8, 300, {3, 3, 3}, 0.2, 0.4);
  const auto pairs_of = [&](Simd simd, int shares) {
    CellGrid cells(simd);
    cells.fill(layout.span(), make_job_runner(1), shares);
    BallPairs pairs;
    for (std::int64_t part = 0; part < cells.parts(); ++part) cells.find_pairs(part, pairs);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> list;
    for (std::int64_t i = 0; i < pairs.size(); ++i) list.emplace_back(pairs.first(i), pairs.second(i));
    return list;
  };
  const auto expected = pairs_of(Simd::portable, 1);
  EXPECT_FALSE(expected.empty());
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512})
    if (simd <= find_simd()) {
      EXPECT_EQ(pairs_of(simd, 1), expected);
      EXPECT_EQ(pairs_of(simd, 3), expected);
    }
}

}  // namespace
}  // namespace lodestone
