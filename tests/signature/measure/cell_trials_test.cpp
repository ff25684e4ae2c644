#include "signature/measure/cell_trials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace lodestone::cell_trials_test {
namespace {

constexpr double kPi = std::numbers::pi;
const CollisionConfiguration kCenter{.theta = 0.6, .phi = 1.0, .psi = 0.5, .speed = 0.8, .spin = 0.6};

CollisionTrial make_trial() {
  static const auto box = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  return CollisionTrial(box, {.restitution = 0.4, .friction = 0.5}, TrialEnd::leaves_plane, 0.0);
}

TEST(CellTrials, EachKeyHasAStartOfItsOwn) {
  const CellSampling sampling{.seed = 3};
  const CellTrial one = cell_trial(kCenter, 7, 2, sampling);
  EXPECT_EQ(one.orientation.coeffs(), cell_trial(kCenter, 7, 2, sampling).orientation.coeffs());
  EXPECT_EQ(one.configuration.psi, cell_trial(kCenter, 7, 2, sampling).configuration.psi);
  for (const CellTrial& other : {cell_trial(kCenter, 7, 3, sampling), cell_trial(kCenter, 8, 2, sampling),
                                 cell_trial(kCenter, 7, 2, {.seed = 4})}) {
    EXPECT_GT(one.orientation.angularDistance(other.orientation), 1e-3);
    EXPECT_GT(std::abs(one.configuration.psi - other.configuration.psi), 1e-6);
  }
}

TEST(CellTrials, PsiIsDrawnOnlyWhereACellHasEvery) {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < 400; ++k) {
    const CellTrial drawn = cell_trial(kCenter, 1, k, {}),
                    kept = cell_trial(kCenter, 1, k, {.every_psi = false});
    EXPECT_EQ(kept.configuration.psi, kCenter.psi);
    EXPECT_EQ(drawn.orientation.coeffs(), kept.orientation.coeffs());
    EXPECT_EQ(drawn.configuration.theta, kCenter.theta);
    sum += std::cos(drawn.configuration.psi);
  }
  EXPECT_LT(std::abs(sum / 400), 0.15);  // three deviations of the mean of a cosine
}

TEST(CellTrials, AUnitHasMeanDeviationAndFactorOfItsResponses) {
  Response a = Response::Zero(), b = Response::Zero();
  a[0] = 1.0f, b[0] = 3.0f, b[4] = 2.0f;
  const CellUnit unit = make_cell_unit(std::vector{a, b});
  EXPECT_EQ(unit.trials, 2U);
  EXPECT_FLOAT_EQ(unit.mean[0], 2.0f);
  EXPECT_FLOAT_EQ(unit.mean[4], 1.0f);
  EXPECT_FLOAT_EQ(unit.deviation[0], std::sqrt(2.0f));  // over n − 1
  EXPECT_FLOAT_EQ(unit.deviation[4], std::sqrt(2.0f));
  EXPECT_EQ(unit.deviation[1], 0.0f);
  EXPECT_FLOAT_EQ(unit.factor[0], std::sqrt(2.0f));   // row 0
  EXPECT_FLOAT_EQ(unit.factor[10], std::sqrt(2.0f));  // row 4, column 0: they go together
  EXPECT_NEAR(unit.factor[14], 0.0f, 1e-5f);          // row 4, column 4: nothing of its own is left
  EXPECT_EQ(make_cell_unit(std::vector{a}).deviation, Response::Zero());
  EXPECT_EQ(make_cell_unit({}).trials, 0U);
}

TEST(CellTrials, ACellIsTheSameWhereverItIsMeasured) {
  const CellSampling sampling{.trials = 20, .keep_responses = true};
  CollisionTrial first = make_trial(), second = make_trial();
  measure_cell(second, kCenter, 6, sampling);  // what was before does not matter
  const CellUnit one = measure_cell(first, kCenter, 5, sampling),
                 other = measure_cell(second, kCenter, 5, sampling);
  EXPECT_EQ(one.mean, other.mean);
  EXPECT_EQ(one.deviation, other.deviation);
  EXPECT_EQ(one.responses, other.responses);
  EXPECT_EQ(one.trials + one.missed, 20U);
  EXPECT_EQ(one.responses.size(), one.trials);
  EXPECT_EQ(one.approaches.size(), one.trials);
  const CellUnit again = make_cell_unit(one.responses);
  EXPECT_EQ(again.mean, one.mean);
  EXPECT_EQ(again.factor, one.factor);
  EXPECT_LT(one.energy_ratio, double(one.trials));  // none gains on average
}

TEST(CellTrials, AnErrorAskedForIsMetOrTheMostTrialsMade) {
  CollisionTrial trial = make_trial();
  const CellUnit coarse = measure_cell(trial, kCenter, 5, {.error = 10.0});
  EXPECT_EQ(coarse.trials + coarse.missed, 24U);  // the first batch
  const CellUnit fine = measure_cell(trial, kCenter, 5, {.error = 0.03});
  EXPECT_GT(fine.trials, 24U);
  EXPECT_LE(double(fine.deviation.maxCoeff()) / std::sqrt(double(fine.trials)), 0.03 * 1.001);
  const CellUnit cut = measure_cell(trial, kCenter, 5, {.error = 1e-6, .most_trials = 50});
  EXPECT_EQ(cut.trials + cut.missed, 50U);
}

TEST(CellTrials, HeldOutConditionsCoverTheTable) {
  double least = 1e9, most = 0.0;
  for (int i = 0; i < 500; ++i) {
    const CollisionConfiguration c = held_out_condition(i, 1);
    EXPECT_TRUE(c.theta >= 0 && c.theta <= kPi / 2 && c.phi >= 0 && c.phi <= kPi && c.psi >= 0 &&
                c.psi <= 2 * kPi);
    EXPECT_NEAR(c.speed_unit(), 1.0, 1e-12);
    least = std::min(least, c.alpha()), most = std::max(most, c.alpha());
  }
  EXPECT_LT(least, 0.02);
  EXPECT_GT(most, kPi / 2 - 0.02);
  EXPECT_NE(held_out_condition(1, 1).theta, held_out_condition(1, 2).theta);
}

}  // namespace
}  // namespace lodestone::cell_trials_test
