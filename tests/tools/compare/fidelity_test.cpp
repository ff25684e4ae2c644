#include "tools/compare/fidelity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "reference/random.h"

namespace lodestone {
namespace {

// Drops whose numbers are independent normals moved by `shift` deviations; a fifth lie on their side.
std::vector<DropObservation> make_drops(int count, std::uint64_t seed, double shift = 0.0) {
  std::vector<DropObservation> drops(count);
  for (int i = 0; i < count; ++i) {
    RandomStream random(seed, i, 0);
    DropObservation& drop = drops[i];
    drop.bounces = int(std::lround(8 + 2 * (random.normal() + shift)));
    drop.rest_time_s = 3 + 0.5 * (random.normal() + shift);
    drop.distance_m = 2 + 0.1 * (random.normal() + shift);
    drop.first_rebound_m = 0.1 + 0.02 * (random.normal() + shift);
    drop.at_rest = true;
    drop.up_in_body = random.uniform() < 0.2 ? Vec3::UnitX() : Vec3::UnitZ();
    for (int t = 0; t < kKineticEnergySamples; ++t)
      drop.kinetic_energy.push_back(float((1 + shift) * random.uniform() * std::exp(-0.02 * t)));
  }
  return drops;
}

TEST(Fidelity, OfTruthWithItselfIsZero) {
  const auto truth = make_drops(50, 1);
  const DropScore score = score_drops(truth, truth).value;
  EXPECT_EQ(score.parts, 6);
  EXPECT_EQ(score.score, 0.0);
}

TEST(Fidelity, AShiftIsMeasuredInTheTruthsDeviations) {
  const auto truth = make_drops(2000, 1);
  auto shifted = truth;
  for (DropObservation& drop : shifted)
    drop.distance_m += 0.2, drop.rest_time_s += 0.25, drop.first_rebound_m -= 0.02;
  const DropScore score = score_drops(truth, shifted, 1, 2).value;
  EXPECT_NEAR(*score.w_distance, 2.0, 0.06);
  EXPECT_NEAR(*score.w_rest_time, 0.5, 0.015);
  EXPECT_NEAR(*score.w_peak, 1.0, 0.03);
  EXPECT_EQ(*score.w_bounces, 0.0);
  EXPECT_EQ(*score.tv, 0.0);
  EXPECT_NEAR(score.score, (*score.w_distance + *score.w_rest_time + *score.w_peak) / 6, 1e-12);
}

TEST(Fidelity, KineticEnergyErrorIsRelative) {
  const auto truth = make_drops(300, 1);
  auto hotter = truth;
  for (DropObservation& drop : hotter)
    for (float& energy : drop.kinetic_energy) energy *= 1.25F;
  EXPECT_NEAR(*score_drops(truth, hotter, 1, 2).value.ke_w, 0.25, 1e-5);
}

TEST(Fidelity, TotalVariationOfRestPoses) {
  const auto truth = make_drops(1000, 1);
  auto method = truth;
  for (int i = 0; i < 100; ++i) method[i].at_rest = false;  // "none"
  for (int i = 100; i < 200; ++i)
    method[i].up_in_body = -Vec3::UnitY();  // a pose the truth has not: "none", too
  EXPECT_NEAR(*score_drops(truth, method, 1, 2).value.tv, 0.2, 1e-12);
}

TEST(Fidelity, RestIsUndefinedWhereTheTruthHardlyRests) {
  auto truth = make_drops(100, 1);
  for (int i = 0; i < 91; ++i) truth[i].at_rest = false;
  const DropScore score = score_drops(truth, make_drops(100, 2)).value;
  EXPECT_FALSE(score.tv.has_value());
  EXPECT_FALSE(score.w_rest_time.has_value());
  EXPECT_EQ(score.parts, 4);
  truth[0].at_rest = true;
  EXPECT_EQ(score_drops(truth, make_drops(100, 2)).value.parts, 6);
}

TEST(Fidelity, PartsWithoutVariationAreUndefined) {
  auto truth = make_drops(100, 1);
  for (DropObservation& drop : truth) drop.bounces = 3;
  const DropScore score = score_drops(truth, make_drops(100, 2)).value;
  EXPECT_FALSE(score.w_bounces.has_value());
  EXPECT_EQ(score.parts, 5);
}

TEST(Fidelity, NoiseFloorFallsWithTheSquareRootOfTheSize) {
  const auto floor = [](int count) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed)
      sum += score_drops(make_drops(count, 2 * seed), make_drops(count, 2 * seed + 1), 1, 1).value.score;
    return sum / 6;
  };
  EXPECT_NEAR(floor(100) / floor(900), 3.0, 0.6);
}

TEST(Fidelity, UnequalSizesScoreAlike) {
  const auto truth = make_drops(900, 1);
  const auto method = make_drops(450, 2, 1.0);
  auto twice = method;
  twice.insert(twice.end(), method.begin(), method.end());
  EXPECT_NEAR(score_drops(truth, twice, 1, 1).value.score, score_drops(truth, method, 1, 1).value.score,
              1e-9);
}

TEST(Fidelity, IntervalRepeatsAndHoldsTheScore) {
  const auto truth = make_drops(200, 1), method = make_drops(200, 2, 0.5);
  const ScoreWithInterval first = score_drops(truth, method, 7, 50),
                          again = score_drops(truth, method, 7, 50);
  EXPECT_EQ(first.interval, again.interval);
  EXPECT_NE(first.interval, score_drops(truth, method, 8, 50).interval);
  EXPECT_LT(first.interval[0], first.value.score);
  EXPECT_GT(first.interval[1], first.value.score);
}

// Where the noise is small beside the score. (At the noise floor the interval is up to √2 too wide.)
TEST(Fidelity, IntervalHasTheWidthOfTheSpreadOverFreshSamples) {
  std::vector<double> scores;
  double width = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const ScoreWithInterval scored =
        score_drops(make_drops(100, 2 * seed), make_drops(100, 2 * seed + 1, 1.0), 1, 60);
    scores.push_back(scored.value.score);
    width += (scored.interval[1] - scored.interval[0]) / 40;
  }
  double mean = 0, variance = 0;
  for (double score : scores) mean += score / 40;
  for (double score : scores) variance += (score - mean) * (score - mean) / 39;
  EXPECT_NEAR(width / (2 * 1.96 * std::sqrt(variance)), 1.0, 0.25);
}

}  // namespace
}  // namespace lodestone
