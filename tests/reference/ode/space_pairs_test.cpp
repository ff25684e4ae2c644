#include "reference/ode/space_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"

namespace lodestone {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

struct Balls {
  std::vector<double> x, y, z;
  std::vector<float> radii;

  explicit Balls(int count) {
    RandomStream random(11, std::uint64_t(count), 0);
    for (int i = 0; i < count; ++i) radii.push_back(float(random.uniform(0.05, i % 10 == 0 ? 1.5 : 0.3)));
    scatter(0);
  }
  void scatter(std::uint32_t round) {
    RandomStream random(12, round, 0);
    x.clear(), y.clear(), z.clear();
    for (std::size_t i = 0; i < radii.size(); ++i)
      for (auto* axis : {&x, &y, &z}) axis->push_back(random.uniform(-3.0, 3.0));
  }
  Pairs all_that_meet() const {
    Pairs pairs;
    for (std::uint32_t a = 0; a < radii.size(); ++a)
      for (std::uint32_t b = a + 1; b < radii.size(); ++b)
        if ((Vec3(x[a], y[a], z[a]) - Vec3(x[b], y[b], z[b])).norm() < double(radii[a]) + double(radii[b]))
          pairs.emplace_back(a, b);
    return pairs;
  }
};

Pairs found_by(OdeSpacePairs& space) {
  Pairs pairs;
  space.find(pairs);
  for (auto& [a, b] : pairs)
    if (a > b) std::swap(a, b);
  std::ranges::sort(pairs);
  return pairs;
}

TEST(OdeSpacePairs, AreThoseOfALookAtAllPairsHoweverTheyMove) {
  for (const OdeSpaceKind kind : {OdeSpaceKind::hash, OdeSpaceKind::sweep_and_prune})
    for (const int count : {1, 2, 60, 150}) {
      Balls balls(count);
      OdeSpacePairs space(kind, balls.radii);
      for (std::uint32_t round = 0; round < 4; ++round) {
        balls.scatter(round);
        space.place(balls.x, balls.y, balls.z);
        EXPECT_EQ(found_by(space), balls.all_that_meet()) << count << ' ' << round;
      }
    }
}

TEST(OdeSpacePairs, AreAddedToWhatIsThere) {
  const std::vector<float> radii = {1.0f, 1.0f};
  const std::vector<double> x = {0, 1.5}, zero = {0, 0};
  OdeSpacePairs space(OdeSpaceKind::hash, radii);
  space.place(x, zero, zero);
  Pairs pairs = {{7, 8}};
  space.find(pairs);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], (std::pair<std::uint32_t, std::uint32_t>(7, 8)));
}

}  // namespace
}  // namespace lodestone
