#include "tools/compare/pile_overlap.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

const std::vector<HalfSpace> kFloor = {HalfSpace{}};

TEST(PileOverlaps, OfBoxesIsHowFarOneMustMove) {
  const auto box = testing::box_shape({0.4, 0.4, 0.4});
  const PileOverlap overlap(*box, kFloor);
  for (const double depth : {0.001, 0.05, 0.15}) {
    EXPECT_NEAR(overlap.depth_of_pair(testing::at({0, 0, 1}), testing::at({0.4 - depth, 0.1, 1.05})), depth,
                1e-9);
    EXPECT_NEAR(overlap.depth_in_planes(testing::at({3, 0, 0.2 - depth})), depth, 1e-12);
  }
  EXPECT_EQ(overlap.depth_of_pair(testing::at({0, 0, 1}), testing::at({0.41, 0, 1})), 0.0);
  EXPECT_LT(overlap.depth_in_planes(testing::at({0, 0, 1})), 0.0);
}

// Whoever is first, and wherever both are.
TEST(PileOverlaps, IsOfThePairAlone) {
  const auto box = testing::box_shape({0.2, 0.3, 0.4});
  const PileOverlap overlap(*box, {});
  RandomStream random(13, 0, 0);
  int overlapping = 0;
  for (int i = 0; i < 100; ++i) {
    const RigidState a = testing::at({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, random.orientation()),
                     b = testing::at(0.3 * random.direction(), {0, 0, 0}, {0, 0, 0}, random.orientation());
    const double depth = overlap.depth_of_pair(a, b);
    overlapping += depth > 0.0;
    EXPECT_NEAR(overlap.depth_of_pair(b, a), depth, 1e-9);
    const Quat turn = random.orientation();
    const Vec3 away = 5.0 * random.direction();
    const auto moved = [&](const RigidState& s) {
      return testing::at(away + turn * s.position, {0, 0, 0}, {0, 0, 0}, turn * s.orientation);
    };
    EXPECT_NEAR(overlap.depth_of_pair(moved(a), moved(b)), depth, 1e-9);
  }
  EXPECT_GT(overlapping, 20);
}

// An L within the notch of another touches nothing, though their hulls do.
TEST(PileOverlaps, OfPiecesIsNotThatOfTheHulls) {
  const Shape l = make_shape("l", make_l(0.6, 0.6, 0.2, 0.2));
  ASSERT_FALSE(l.convex);
  const PileOverlap overlap(l, {});
  const RigidState one = testing::at({0, 0, 0}), notched = testing::at({0.25, 0.25, 0});
  EXPECT_GT(measure_pair_overlap(l, one, l, testing::at({0.1, 0.1, 0})), 0.0);
  EXPECT_EQ(overlap.depth_of_pair(one, notched), 0.0);
  EXPECT_NEAR(overlap.depth_of_pair(one, testing::at({0, 0, 0.19})), 0.01, 1e-9);
}

TEST(PileOverlaps, DeepestIsThatOfAnyPairOrPlane) {
  const auto box = testing::box_shape({0.4, 0.4, 0.4});
  const PileOverlap overlap(*box, kFloor);
  std::vector<RigidState> states = {testing::at({0, 0, 0.2}), testing::at({1, 0, 0.2}),
                                    testing::at({2, 0, 0.2})};
  EXPECT_NEAR(overlap.deepest(states), 0.0, 1e-12);
  states[2].position.z() = 0.17;
  EXPECT_NEAR(overlap.deepest(states), 0.03, 1e-12);
  states[1].position.x() = 0.35;
  EXPECT_NEAR(overlap.deepest(states), 0.05, 1e-9);
  EXPECT_EQ(overlap.deepest({}), 0.0);
}

TEST(PileOverlaps, WhatRestsOnNothingHoversAndWhatFellThroughEscaped) {
  const auto box = testing::box_shape({0.4, 0.4, 0.4});
  const PileOverlap overlap(*box, kFloor);
  const std::vector<RigidState> states = {testing::at({0, 0, 0.2}), testing::at({0, 0, 0.6}),
                                          testing::at({3, 0, 0.25}), testing::at({6, 0, 2}),
                                          testing::at({9, 0, -0.1})};
  const std::vector<char> at_rest = {1, 1, 1, 0, 0};
  EXPECT_EQ(overlap.count_hovering(states, at_rest, 0.01), 1);  // the third
  EXPECT_EQ(overlap.count_hovering(states, at_rest, 0.06), 0);
  EXPECT_EQ(overlap.count_hovering(states, std::vector<char>(5, 1), 0.01), 2);
  EXPECT_EQ(overlap.count_escaped(states), 1);
}

}  // namespace
}  // namespace lodestone
