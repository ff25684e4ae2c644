#include "lod/contact/free_way.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodestone {
namespace {

constexpr double kWayBall = 0.1;  // m

// A wall of 5 cm at x = 1, up to y = 2, on a floor whose upper side is at z = 0.
class FreeWay : public ::testing::Test {
 protected:
  FreeWay() {
    ground_.add_box({0.05, 4, 4}, {1.025, 0, 0}, Quat::Identity(), 0);
    ground_.add_box({9, 9, 1}, {0, 0, -0.5}, Quat::Identity(), 0);
  }
  double of_ball(const Vec3& from, const Vec3& way) const {
    return find_free_way(ground_, from, way, kWayBall, [](const Vec3&) { return kWayBall; });
  }
  Ground ground_;
};

TEST_F(FreeWay, EndsAtAWall) {
  EXPECT_NEAR(of_ball({0, 0, 1}, {3, 0, 0}), 0.9 / 3, 1e-3);
  EXPECT_NEAR(of_ball({0, 0, 1}, {3, 1, 0}), 0.9 / 3, 1e-3);
  EXPECT_EQ(of_ball({0, 0, 1}, {0.8, 0, 0}), 1.0);
  EXPECT_EQ(of_ball({0, 0, 1}, {-3, 0, 0}), 1.0);
}

TEST_F(FreeWay, GoesOnPastAnEdge) {
  EXPECT_EQ(of_ball({0, 2.2, 1}, {3, 0, 0}), 1.0);
  EXPECT_LT(of_ball({0, 2.05, 1}, {3, 0, 0}), 0.33);
}

// What it touches is its contacts' matter: on the floor it goes along, and is not held by it.
TEST_F(FreeWay, IsNotEndedByWhatIsTouchedAtTheBeginning) {
  EXPECT_NEAR(of_ball({0, 0, kWayBall}, {3, 0, -0.1}), 0.9 / 3, 1e-3);
  EXPECT_EQ(of_ball({0.9, 0, 1}, {3, 0, 0}), 1.0);
}

TEST_F(FreeWay, OfABoxIsThatOfItsHull) {
  const Shape box = make_shape("box", make_box({0.2, 0.2, 0.2}));
  StatisticalBody body;
  body.orientation = Quat(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitZ()));
  EXPECT_NEAR(find_free_way(ground_, body, box, {0, 0, 1}, {3, 0, 0}), (1 - 0.1 * std::sqrt(2.0)) / 3, 1e-3);
}

}  // namespace
}  // namespace lodestone
