#include "lod/statistical/broad_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "reference/random.h"

namespace lodestone {
namespace {

using Pairs = std::set<std::pair<int, int>>;

std::vector<Bound> random_bounds(int count, double box, double reach_min, double reach_max, std::uint64_t seed) {
  std::vector<Bound> bounds;
  for (int i = 0; i < count; ++i) {
    RandomStream random(seed, std::uint64_t(i), 0);
    bounds.push_back({{random.uniform(-box, box), random.uniform(-box, box), random.uniform(-box, box)}, random.uniform(reach_min, reach_max)});
  }
  return bounds;
}

bool overlap(const Bound& a, const Bound& b) { return (a.center - b.center).norm() < a.reach + b.reach; }

void expect_all_pairs(const std::vector<Bound>& moving, const std::vector<Bound>& still) {
  Pairs expected;
  for (int i = 0; i < int(moving.size()); ++i) {
    for (int j = i + 1; j < int(moving.size()); ++j)
      if (overlap(moving[i], moving[j])) expected.insert({i, j});
    for (int j = 0; j < int(still.size()); ++j)
      if (overlap(moving[i], still[j])) expected.insert({i, -1 - j});
  }
  BroadPhase broad_phase;
  broad_phase.set_still(still);
  std::vector<NearPair> pairs;
  broad_phase.find_pairs(moving, pairs);
  Pairs found;
  for (const NearPair& p : pairs) EXPECT_TRUE(found.insert({p.first, p.second}).second) << "found twice: " << p.first << ", " << p.second;
  EXPECT_EQ(found, expected);
}

TEST(BroadPhase, FindsEachOverlappingPairOnceInACrowd) { expect_all_pairs(random_bounds(800, 1.0, 0.05, 0.1, 1), random_bounds(300, 1.0, 0.05, 0.1, 2)); }

TEST(BroadPhase, FindsPairsOfVeryDifferentSizes) {
  std::vector<Bound> mixed = random_bounds(500, 5.0, 0.01, 0.02, 3);
  const std::vector<Bound> boulders = random_bounds(6, 5.0, 2.0, 5.0, 4);
  mixed.insert(mixed.end(), boulders.begin(), boulders.end());
  expect_all_pairs(mixed, mixed);
}

TEST(BroadPhase, CopesWithFarPositionsAndEmptySets) {
  std::vector<Bound> far = random_bounds(50, 1e7, 0.1, 0.2, 5);
  far.push_back({{1e12, 0, 0}, 0.2});
  far.push_back({{1e12, 0, 0}, 0.2});
  expect_all_pairs(far, {});
  expect_all_pairs({}, far);
}

}  // namespace
}  // namespace lodestone
