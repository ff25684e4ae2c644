#include "lod/broad_phase/still_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "reference/random.h"

namespace lodestone {
namespace {

struct Lying {
  Vec3 position;
  double radius;
};

Lying lying(std::uint32_t body) {
  RandomStream random(8, body, 0);
  const Vec3 position(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-1, 1));
  return {position, body % 50 == 0 ? 4.0 : random.uniform(0.05, 0.3)};
}

std::set<std::uint32_t> near(const StillGrid& grid, const Vec3& center, double reach) {
  std::set<std::uint32_t> found;
  grid.find_near(center, reach, [&](std::uint32_t body) { EXPECT_TRUE(found.insert(body).second) << body; });
  return found;
}

TEST(StillGrid, FindsWhatLiesNearWhoeverCameAndWent) {
  StillGrid grid;
  EXPECT_TRUE(grid.empty());
  std::set<std::uint32_t> inside;
  for (std::uint32_t round = 0; round < 6000; ++round) {
    RandomStream random(9, round, 0);
    const auto body = std::uint32_t(random.uniform() * 1000);
    const Lying l = lying(body);
    if (inside.erase(body))
      grid.remove(body, l.position, l.radius);
    else
      inside.insert(body), grid.insert(body, l.position, l.radius);
    if (round % 100) continue;
    const Vec3 center(random.uniform(-22, 22), random.uniform(-22, 22), 0);
    const double reach = random.uniform(0.1, 3.0);
    const auto found = near(grid, center, reach);
    for (const std::uint32_t other : inside) {
      const bool reaches = (lying(other).position - center).norm() < reach + lying(other).radius;
      EXPECT_TRUE(!reaches || found.contains(other)) << other;
    }
    for (const std::uint32_t other : found) EXPECT_TRUE(inside.contains(other)) << other;
  }
  for (const std::uint32_t body : inside) grid.remove(body, lying(body).position, lying(body).radius);
  EXPECT_TRUE(grid.empty());
  EXPECT_TRUE(near(grid, Vec3::Zero(), 100.0).empty());
}

// Cell by cell, however wide: so balls of one cell come one after the other, and cells by z, y and x.
TEST(StillGrid, IsLookedThroughCellByCellByWhatIsLarge) {
  constexpr double kEdge = 0.5, kRadius = 0.2;  // m, of a ball of this radius
  struct Place {
    Vec3 at;
    std::array<double, 3> cell;  // z first
  };
  StillGrid grid;
  std::vector<Place> places;
  for (std::uint32_t body = 0; body < 20'000; ++body) {
    RandomStream random(12, body, 0);
    const Vec3 at(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    places.push_back(
        {at, {std::floor(at.z() / kEdge), std::floor(at.y() / kEdge), std::floor(at.x() / kEdge)}});
    grid.insert(body, at, kRadius);
  }
  for (const Vec3& center : {Vec3(0.3, -0.2, 0.1), Vec3(-5.0, 6.0, 2.0), Vec3(30.0, 0.0, 0.0)})
    for (const double reach : {1.5, 3.0, 4.5}) {
      std::vector<std::uint32_t> found;
      grid.find_near(center, reach, [&](std::uint32_t body) { found.push_back(body); });
      EXPECT_TRUE(std::ranges::is_sorted(found, {}, [&](std::uint32_t body) { return places[body].cell; }));
      std::ranges::sort(found);
      for (std::uint32_t body = 0; body < places.size(); ++body)
        EXPECT_TRUE((places[body].at - center).norm() >= reach + kRadius ||
                    std::ranges::binary_search(found, body))
            << body;
    }
}

// Whoever looked once knows who is there until the number changes.
TEST(StillGrid, NobodyArrivesUnannounced) {
  struct Watch {
    Vec3 center;
    double reach;
    std::optional<std::uint64_t> arrivals;
  };
  StillGrid grid;
  std::vector<Watch> watches;
  std::set<std::uint32_t> inside;
  int told = 0, kept = 0, arrived = 0;
  for (std::uint32_t round = 0; round < 3000; ++round) {
    RandomStream random(11, round, 0);
    const auto body = std::uint32_t(random.uniform() * 1000);
    Lying l = lying(body);
    l.position *= 0.2;  // close together
    if (inside.erase(body))
      grid.remove(body, l.position, l.radius);
    else
      inside.insert(body), grid.insert(body, l.position, l.radius);
    for (Watch& watch : watches) {
      const auto now = grid.arrivals_near(watch.center, watch.reach);
      ASSERT_TRUE(now);
      const bool comes =
          inside.contains(body) && (l.position - watch.center).norm() < watch.reach + 1.02 * l.radius;
      if (comes) {
        EXPECT_NE(*now, *watch.arrivals) << round;
        ++arrived;
      }
      told += *now != *watch.arrivals, kept += *now == *watch.arrivals;
      watch.arrivals = now;
    }
    if (round % 60) continue;
    const Vec3 center(random.uniform(-4, 4), random.uniform(-4, 4), 0);
    const double reach = random.uniform(0.05, 0.24);  // beside bodies of a tenth at least
    watches.push_back({center, reach, grid.arrivals_near(center, reach)});
    EXPECT_TRUE(watches.back().arrivals);
  }
  EXPECT_GT(arrived, 300);
  EXPECT_GT(kept, 5 * told);
  EXPECT_FALSE(grid.arrivals_near(Vec3::Zero(), 10.0));
}

TEST(StillGrid, WhatWasReadFromASnapshotIsNew) {
  StillGrid grid;
  grid.insert(3, {0, 0, 0}, 0.1);
  const auto before = grid.arrivals_near({0, 0, 0}, 0.1);
  StateArchive writer;
  grid.archive(writer);
  EXPECT_EQ(grid.arrivals_near({0, 0, 0}, 0.1), before);
  StateArchive reader(writer.bytes(), {});
  grid.archive(reader);
  EXPECT_NE(grid.arrivals_near({0, 0, 0}, 0.1), before);
}

// In the same order, too.
TEST(StillGrid, AnswersAlikeAfterItWasRestored) {
  StillGrid plain, restored;
  std::set<std::uint32_t> inside;
  const auto list = [](const StillGrid& grid, const Vec3& center, double reach) {
    std::vector<std::uint32_t> found;
    grid.find_near(center, reach, [&](std::uint32_t body) { found.push_back(body); });
    return found;
  };
  std::size_t found = 0;
  for (std::uint32_t round = 0; round < 4000; ++round) {
    RandomStream random(10, round, 0);
    const auto body = std::uint32_t(random.uniform() * 500);
    const Lying l = lying(body);
    if (inside.erase(body))
      plain.remove(body, l.position, l.radius), restored.remove(body, l.position, l.radius);
    else
      inside.insert(body), plain.insert(body, l.position, l.radius),
          restored.insert(body, l.position, l.radius);
    if (round == 2000) {
      StateArchive writer;
      restored.archive(writer);
      StateArchive reader(writer.bytes(), {});
      restored = StillGrid();
      restored.insert(7777, Vec3(1, 1, 0), 0.1);  // of another world
      restored.archive(reader);
    }
    const Vec3 center(random.uniform(-22, 22), random.uniform(-22, 22), random.uniform(-1.5, 1.5));
    for (const double reach : {0.02, 0.25, 0.7, 5.0}) {
      const auto expected = list(plain, center, reach);
      EXPECT_EQ(list(restored, center, reach), expected) << round << ' ' << reach;
      found += expected.size();
    }
  }
  EXPECT_GT(found, 4000u);
}

}  // namespace
}  // namespace lodestone
