#include "tools/compare/pile_observation.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "tools/compare/pile_start.h"

namespace lodestone {
namespace {

RigidState at(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return {.position = position, .velocity = velocity};
}

class Boxes : public ::testing::Test {
 protected:
  Shape shape_ = make_shape("box", make_box({0.2, 0.2, 0.2}));
  PileOverlap overlap_{shape_, make_bin(2.0)};

  PileObservation observe(std::vector<std::vector<RigidState>> samples) {
    PileObserver observer(shape_, overlap_);
    for (std::size_t i = 0; i < samples.size(); ++i) observer.sample(double(i) / 60.0, samples[i]);
    return observer.result();
  }
};

TEST_F(Boxes, DepthIsThatOfPairsAndOfPlanes) {
  EXPECT_NEAR(overlap_.depth_of_pair(at({0, 0, 1}), at({0.19, 0, 1})), 0.01, 1e-9);
  EXPECT_EQ(overlap_.depth_of_pair(at({0, 0, 1}), at({0.21, 0, 1})), 0.0);
  EXPECT_NEAR(overlap_.depth_in_planes(at({0, 0, 0.08})), 0.02, 1e-12);
  EXPECT_NEAR(overlap_.depth_in_planes(at({0, -0.95, 0.5})), 0.05, 1e-12);
  EXPECT_NEAR(observe({{at({0, 0, 0.08}), at({0.19, 0, 0.1})}}).max_penetration_m, 0.02, 1e-9);
}

// Of three pairs that overlap, by 1, 2 and 5 cm; apart from a fourth. What lay deeper before does not count.
TEST_F(Boxes, OverlapAtTheEndIsOfWhatIsThenInEachOther) {
  const auto beside = [](double y, double depth) {
    return std::pair{at({0, y, 0.1}), at({0.2 - depth, y, 0.1})};
  };
  std::vector<RigidState> states;
  for (const auto& [y, depth] : {std::pair{-0.6, 0.01}, {-0.3, 0.05}, {0.0, 0.02}, {0.3, -0.01}}) {
    const auto [one, other] = beside(y, depth);
    states.push_back(one), states.push_back(other);
  }
  std::vector<RigidState> deeper = states;
  deeper[5].position.x() = 0.1;
  const PileObservation pile = observe({deeper, states});
  EXPECT_NEAR(pile.median_penetration_m, 0.02, 1e-9);
  EXPECT_NEAR(pile.end_penetration_m, 0.05, 1e-9);
  EXPECT_NEAR(pile.max_penetration_m, 0.1, 1e-9);
  EXPECT_EQ(observe({{at({0, 0, 0.1}), at({0.5, 0, 0.1})}}).median_penetration_m, 0.0);
}

TEST_F(Boxes, WhatRestsOnNothingHovers) {
  const std::vector<RigidState> states = {at({0, 0, 0.1}), at({0, 0, 0.301}), at({0.5, 0, 0.15})};
  EXPECT_EQ(observe(std::vector(31, states)).hovering, 1);
}

TEST_F(Boxes, WhatFallsDoesNotHover) {
  EXPECT_EQ(observe(std::vector(31, std::vector{at({0, 0, 1}, {0, 0, -1})})).hovering, 0);
}

TEST_F(Boxes, WhoseCentreIsBehindAPlaneHasEscaped) {
  EXPECT_EQ(observe({{at({1.1, 0, 0.1}), at({0.9, 0, 0.1}), at({0, 0, -0.1})}}).escaped, 2);
}

TEST_F(Boxes, ARiseOfEnergyIsOverTheLeastBefore) {
  const double g = 9.81;
  const auto high = [](double z) { return std::vector{at({0, 0, z})}; };
  EXPECT_NEAR(observe({high(2.0), high(1.0), high(1.5), high(1.2)}).energy_rise, 0.5 * g / (2.0 * g), 1e-12);
  EXPECT_EQ(observe({high(2.0), {at({0, 0, 1.0}, {0, 0, -1})}, high(1.0)}).energy_rise, 0.0);
}

TEST_F(Boxes, TheTimeToSleepIsTheMeanOfTheLastStirs) {
  const auto moving = at({0, 0, 0.1}, {0.1, 0, 0}), still = at({0.5, 0, 0.1});
  EXPECT_NEAR(observe({{still, still}, {moving, still}, {moving, moving}, {still, moving}}).sleep_time_s,
              2.5 / 60.0, 1e-12);
}

// Longer steps are laid beside the truth in time.
TEST_F(Boxes, TheEnergyOfLongerStepsIsOnALineBetweenThem) {
  const auto moving = [](double v) { return std::vector{at({0, 0, 0.5}, {v, 0, 0})}; };
  PileObserver observer(shape_, overlap_);
  for (int i = 0; i < 4; ++i) observer.sample(i / 15.0, moving(std::sqrt(2.0 * i)));
  const std::vector<double> energy = observer.result().kinetic_energy;
  ASSERT_EQ(energy.size(), 13U);
  for (std::size_t i = 0; i < energy.size(); ++i) EXPECT_NEAR(energy[i], double(i) / 4.0, 1e-12);
}

// Overlaps are looked at ten times a second, or in each step that is longer.
TEST_F(Boxes, OverlapIsLookedAtTenTimesASecond) {
  const auto deep = [](bool is) { return std::vector{at({0, 0, is ? 0.05 : 0.1})}; };
  for (const auto& [steps_per_s, of] : {std::pair{60, 6}, {10, 1}, {5, 1}})
    for (int deepest = 0; deepest < 12; ++deepest) {
      PileObserver observer(shape_, overlap_);
      for (int i = 0; i < 13; ++i) observer.sample(double(i) / steps_per_s, deep(i == deepest));
      EXPECT_EQ(observer.result().max_penetration_m > 0.01, deepest % of == 0)
          << steps_per_s << " " << deepest;
    }
}

TEST(PileOverlap, OfConcaveBodiesIsThatOfTheBodiesNotOfTheirHulls) {
  const Shape l = make_shape("l", make_l(0.3, 0.2, 0.08, 0.1));
  ASSERT_FALSE(l.pieces.empty());
  const PileOverlap by_pieces(l, {});
  Shape whole = l;
  whole.pieces.clear();
  const PileOverlap by_grid(whole, {});
  // The same way up, shifted diagonally: corner in the other's notch, .02 m off both of its inner sides.
  const RigidState in_notch = at({0.1, 0.1, 0});
  EXPECT_EQ(by_pieces.depth_of_pair(in_notch, at({0, 0, 0})), 0.0);
  EXPECT_EQ(by_grid.depth_of_pair(in_notch, at({0, 0, 0})), 0.0);
  const RigidState too_low = at({0.1, 0.07, 0});
  EXPECT_NEAR(by_pieces.depth_of_pair(too_low, at({0, 0, 0})), 0.01, 1e-6);
  EXPECT_GT(by_grid.depth_of_pair(at({0.1, 0.05, 0.03}), at({0, 0, 0})), 0.015);
}

TEST(PileStart, IsWithinTheBinWithoutOverlap) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  const PileConditions conditions{.bodies = 40, .side = 1.6};
  const auto starts = make_pile_start(shape, conditions, 3);
  const PileOverlap overlap(shape, make_bin(1.6));
  ASSERT_EQ(starts.size(), 40U);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    EXPECT_LT(overlap.depth_in_planes(starts[i]), 0.0);
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GE((starts[i].position - starts[k].position).norm(), 2.0 * shape.radius);
  }
}

TEST(PileStart, ABinTooNarrowIsBadInput) {
  const Shape shape = make_shape("box", make_box({0.2, 0.3, 0.4}));
  EXPECT_THROW(make_pile_start(shape, {.bodies = 2, .side = 0.5}, 1), InputError);
}

}  // namespace
}  // namespace lodestone
