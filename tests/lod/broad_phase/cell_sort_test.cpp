// The order in which cells hold their balls: each once, cell by cell.
#include <gtest/gtest.h>

#include <algorithm>

#include "lod/broad_phase/cell_grid.h"
#include "reference/random.h"

namespace lodestone {
namespace {

struct Places {
  std::vector<double> x, y, z;
  std::vector<float> reach;
  BallSpan span() const { return {x, y, z, reach}; }
};

Places draw_places(std::uint32_t seed, int count, double half, double reach) {
  RandomStream random(29, seed, 0);
  Places places;
  for (int i = 0; i < count; ++i) {
    for (auto* axis : {&places.x, &places.y, &places.z}) axis->push_back(random.uniform(-half, half));
    places.reach.push_back(float(reach * random.uniform(0.8, 1.0)));
  }
  return places;
}

std::vector<std::uint32_t> order_of(const CellGrid& cells) {
  const auto order = cells.order();
  return {order.begin(), order.end()};
}

TEST(CellSort, HoldsEachBallOnce) {
  for (const int count : {0, 1, 7, 100, 1000, 9000}) {
    CellGrid cells;
    const Places places = draw_places(1, count, 5.0, 0.3);
    cells.fill(places.span());
    std::vector<std::uint32_t> order = order_of(cells);
    ASSERT_EQ(order.size(), std::size_t(count));
    std::ranges::sort(order);
    for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) EXPECT_EQ(order[i], i);
  }
}

// Neighbours in the order are mostly neighbours in space: that is what the sorting is for.
TEST(CellSort, WhoFollowEachOtherAreNear) {
  CellGrid cells;
  const Places places = draw_places(2, 2000, 5.0, 0.3);
  cells.fill(places.span());
  const std::vector<std::uint32_t> order = order_of(cells);
  const auto apart = [&](std::uint32_t a, std::uint32_t b) {
    return (Vec3(places.x[a], places.y[a], places.z[a]) - Vec3(places.x[b], places.y[b], places.z[b])).norm();
  };
  double sorted = 0.0, as_given = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i)
    sorted += apart(order[i - 1], order[i]), as_given += apart(std::uint32_t(i - 1), std::uint32_t(i));
  EXPECT_LT(sorted, 0.6 * as_given);  // every eighth is the first of another row
}

// The same on any number of threads and at any width, also when it is filled again with others.
TEST(CellSort, IsTheSameHoweverTheWorkIsShared) {
  const JobRunner one = make_job_runner(1), two = make_job_runner(2);
  CellGrid again(find_simd());
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    const Places places = draw_places(seed, 9000, 8.0, 0.3);
    CellGrid portable(Simd::portable);
    portable.fill(places.span(), one, 1);
    again.fill(places.span(), two, 4);
    EXPECT_EQ(order_of(again), order_of(portable));
  }
}

// Few, but very many cells apart: memory is by the balls, not by the room between them.
TEST(CellSort, MemoryIsByTheBalls) {
  CellGrid near, far;
  const Places close = draw_places(3, 500, 3.0, 0.3), wide = draw_places(3, 500, 3e5, 0.3);
  near.fill(close.span()), far.fill(wide.span());
  EXPECT_LT(far.bytes(), 4 * near.bytes());
  EXPECT_LT(far.bytes(), 500U * 400);
}

}  // namespace
}  // namespace lodestone
