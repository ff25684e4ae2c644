#include "tools/compare/impact_errors.h"

#include <gtest/gtest.h>

#include <vector>

namespace lodestone {
namespace {

DropObservation with_impact(const Vec3& before, const Vec3& after) {
  DropObservation drop;
  drop.first_impact = FirstImpact{before, after};
  return drop;
}

TEST(ImpactErrors, AreInTenthsOfTheTruthsImpulse) {
  const std::vector<DropObservation> truth(3, with_impact({0, 0, -2}, {0, 0, 2}));
  const std::vector<DropObservation> method = {with_impact({0, 0, -2}, {0, 0, 2}),
                                               with_impact({0, 0, -2}, {0, 0.8, 2}),
                                               with_impact({0, 0, -2}, {0, 0, 1})};
  const auto errors = measure_impact_errors(truth, method);
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->impacts, 3);
  EXPECT_NEAR(errors->impulse_median, 2.0, 1e-12);
  EXPECT_NEAR(errors->impulse_mean, 4.5 / 3, 1e-12);
  EXPECT_NEAR(errors->unnoticed, 1.0 / 3, 1e-12);
  EXPECT_NEAR(errors->speed_change, (0.0 + std::sqrt(0.64 + 4.0) / 2.0 - 1.0 - 0.5) / 3, 1e-12);
}

TEST(ImpactErrors, CountOnlyDropsWhereBothBounce) {
  const std::vector<DropObservation> truth = {with_impact({0, 0, -2}, {0, 0, 2}), {}}, none(2);
  EXPECT_FALSE(measure_impact_errors(truth, none));
  EXPECT_EQ(measure_impact_errors(truth, truth)->impacts, 1);
}

}  // namespace
}  // namespace lodestone
