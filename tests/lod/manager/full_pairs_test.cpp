#include "lod/manager/full_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

FullPairs::Body body_at(const Vec3& position, bool asleep = false) {
  return {.position = position, .radius = 1.0, .mesh = 1.0f, .asleep = asleep};
}

PairWeights pair_of(const FullPairs::Body& first, const FullPairs::Body& second) {
  FullPairs pairs(2.0);
  pairs.add(first);
  return pairs.meet(second);
}

TEST(FullPairs, CountMoreTheDeeperTheyMeet) {
  EXPECT_EQ(pair_of(body_at({0, 0, 0}), body_at({0, 2.0, 0})).awake, 0.0);
  EXPECT_NEAR(pair_of(body_at({0, 0, 0}), body_at({0, 1.6, 0})).awake, 0.5, 1e-12);
  EXPECT_EQ(pair_of(body_at({0, 0, 0}), body_at({0, 1.0, 0})).awake, 1.0);
}

TEST(FullPairs, SleepersCountApart) {
  const PairWeights one = pair_of(body_at({0, 0, 0}, true), body_at({1, 0, 0})),
                    both = pair_of(body_at({0, 0, 0}, true), body_at({1, 0, 0}, true));
  EXPECT_EQ(one.awake, 1.0);
  EXPECT_EQ(one.dearest, 1.0);
  EXPECT_EQ(both.awake, 0.0);
  EXPECT_EQ(both.asleep, 1.0);
  EXPECT_EQ(both.dearest, 0.0);
}

TEST(FullPairs, CellsFindAllThatMeet) {
  RandomStream random(5, 1, 0);
  FullPairs pairs(1.0);
  std::vector<FullPairs::Body> bodies;
  for (int i = 0; i < 400; ++i) {
    FullPairs::Body body = body_at(
        12.0 * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5), i % 3 == 0);
    body.radius = 0.2 + 0.8 * random.uniform();
    const PairWeights met = pairs.meet(body);
    PairWeights expected;
    for (const FullPairs::Body& other : bodies) {
      const PairWeights pair = pair_of(other, body);
      expected.awake += pair.awake, expected.asleep += pair.asleep,
          expected.dearest = std::max(expected.dearest, pair.dearest);
    }
    EXPECT_NEAR(met.awake, expected.awake, 1e-9) << i;
    EXPECT_NEAR(met.asleep, expected.asleep, 1e-9) << i;
    EXPECT_EQ(met.dearest, expected.dearest) << i;
    pairs.add(body);
    bodies.push_back(body);
  }
}

TEST(FullPairs, ConcaveMeshesOfManyFacesWeighMost) {
  EXPECT_LT(mesh_weight(*box_shape({1, 1, 1})), 0.5);
  EXPECT_NEAR(mesh_weight(make_bunny_shape(0.2)), 1.0, 0.01);
}

}  // namespace
}  // namespace lodestone
