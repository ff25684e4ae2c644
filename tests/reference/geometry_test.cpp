#include "reference/geometry.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(RotationFromVector, IsTheRotationAboutTheVectorOnBothSidesOfHalfARadian) {
  const Vec3 axis = Vec3(1.0, -2.0, 0.5).normalized();
  for (const double angle : {0.0, 1e-12, 1e-4, 0.1, 0.4999, 0.5001, 1.0, 3.0, 20.0}) {
    const Quat expected(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT((rotation_from_vector(angle * axis).coeffs() - expected.coeffs()).norm(), 4e-16) << angle;
  }
}

}  // namespace
}  // namespace lodestone
