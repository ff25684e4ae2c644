#include "reference/mass_bounds.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/error.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

Shape box_with_moments(const Vec3& moments) {
  Shape box = *testing::box_shape({2, 2, 2});  // its corners 2 m² from each axis
  box.inertia_per_mass = moments.asDiagonal();
  return box;
}

TEST(MassBounds, AreThemselvesWithin) {
  EXPECT_NO_THROW(check_mass(kLeastMass));
  EXPECT_NO_THROW(check_mass(kGreatestMass));
  for (const double mass :
       {0.0, -1.0, 0.999 * kLeastMass, 1.001 * kGreatestMass, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(check_mass(mass), InputError) << mass;
}

TEST(MassBounds, SolidsHaveTheMomentsTheyNeed) {
  for (const Vec3& sides : {Vec3(1, 1, 1), Vec3(1, 1, 1e-3), Vec3(1e-3, 1e-3, 1)})
    EXPECT_NO_THROW(check_inertia(*testing::box_shape(sides)));
  EXPECT_NO_THROW(check_inertia(make_sphere_shape(0.1)));
}

// Of any body I₁ + I₂ ≥ I₃: equal for a plate.
TEST(MassBounds, MomentsKeepTheTriangleInequality) {
  EXPECT_NO_THROW(check_inertia(box_with_moments({1, 2, 3})));
  EXPECT_THROW(check_inertia(box_with_moments({1, 2, 3.01})), InputError);
  EXPECT_THROW(check_inertia(box_with_moments({-1, 2, 2})), InputError);
  EXPECT_THROW(check_inertia(box_with_moments({0, 2, 2})), InputError);
}

TEST(MassBounds, AMomentIsHeldAgainstTheExtentAboutItsOwnAxis) {
  const double least = kLeastMoment * 2.0;
  EXPECT_NO_THROW(check_inertia(box_with_moments({1.01 * least, 1, 1})));
  EXPECT_THROW(check_inertia(box_with_moments({0.99 * least, 1, 1})), InputError);
  // A rod's corners are near its axis: the same moment is enough about that axis alone.
  Shape rod = *testing::box_shape({2, 0.02, 0.02});
  rod.inertia_per_mass = Vec3(1e-8, 0.3, 0.3).asDiagonal();
  EXPECT_NO_THROW(check_inertia(rod));
  rod.inertia_per_mass = Vec3(0.3, 1e-8, 0.3).asDiagonal();
  EXPECT_THROW(check_inertia(rod), InputError);
}

}  // namespace
}  // namespace lodestone
