#include "tools/compare/drop_observation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr double kStep = 1.0 / 60.0, kGravity = 9.81;

// A cube of side .2 m whose middle follows `height` and `speed` along `normal`.
template <typename Height, typename Speed>
DropObservation observe(double seconds, Height height, Speed speed, const Vec3& normal = Vec3::UnitZ()) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  DropObserver observer(cube, normal, kGravity);
  RigidState state;
  for (int i = 0; i <= std::lround(seconds / kStep); ++i) {
    state.position = height(i * kStep) * normal;
    state.velocity = speed(i * kStep) * normal;
    observer.sample(i * kStep, state);
  }
  return observer.result();
}

// Without rotation, from rest at 1.1 m: the lowest point falls 1 m, then leaves with half its speed, for two
// bounces.
struct BouncingCube {
  double fall = std::sqrt(2.0 / kGravity), impact = std::sqrt(2.0 * kGravity),
         second = fall + impact / kGravity;
  double height(double t) const {
    if (t < fall) return 1.1 - 0.5 * kGravity * t * t;
    if (t < second) return 0.1 + 0.5 * impact * (t - fall) - 0.5 * kGravity * (t - fall) * (t - fall);
    return 0.1;
  }
  double speed(double t) const {
    if (t < fall) return -kGravity * t;
    if (t < second) return 0.5 * impact - kGravity * (t - fall);
    return 0.0;
  }
};

TEST(DropObservation, FreeFallHasNoBounce) {
  const DropObservation drop = observe(
      2.0, [](double t) { return 50 - 0.5 * kGravity * t * t; }, [](double t) { return -kGravity * t; });
  EXPECT_EQ(drop.bounces, 0);
  EXPECT_EQ(drop.first_rebound_m, 0.0);
  EXPECT_FALSE(drop.at_rest);
  EXPECT_NEAR(drop.rest_time_s, 2.0, 1e-9);
}

TEST(DropObservation, LyingStillHasNoBounceAndRests) {
  const DropObservation drop = observe(
      1.0, [](double) { return 0.1; }, [](double) { return 0.0; });
  EXPECT_EQ(drop.bounces, 0);
  EXPECT_TRUE(drop.at_rest);
  EXPECT_EQ(drop.rest_time_s, 0.0);
}

TEST(DropObservation, CountsBouncesAndMeasuresTheFirstRebound) {
  const BouncingCube cube;
  const DropObservation drop = observe(
      3.0, [&](double t) { return cube.height(t); }, [&](double t) { return cube.speed(t); });
  EXPECT_EQ(drop.bounces, 2);
  ASSERT_TRUE(drop.first_impact);
  EXPECT_LT((drop.first_impact->impulse() - Vec3(0, 0, 1.5 * cube.impact)).norm(), 1e-9);
  EXPECT_NEAR(drop.first_rebound_m, 0.25, 2e-3);  // e² of the height it fell, less what 60 Hz misses
  EXPECT_NEAR(drop.rest_time_s, cube.second, kStep);
  EXPECT_TRUE(drop.at_rest);
}

// What lies there seems to rise by g Δt, .33 m/s at 30 Hz.
TEST(DropObservation, LyingStillHasNoBounceHoweverSeldomItIsLookedAt) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  DropObserver observer(cube, Vec3::UnitZ(), kGravity);
  RigidState state;
  state.position.z() = 0.1;
  for (int i = 0; i <= 30; ++i) observer.sample(i / 30.0, state);
  EXPECT_EQ(observer.result().bounces, 0);
}

TEST(DropObservation, UpwardStepsOfTheVelocityBelowTheThresholdAreNoBounces) {
  const auto rising = [](double rise) {
    return observe(
               1.0, [](double) { return 0.1; },
               [=](double t) { return t < 0.5 ? 0.0 : rise - kGravity * kStep; })
        .bounces;
  };
  EXPECT_EQ(rising(0.29), 0);
  EXPECT_EQ(rising(0.31), 1);
}

// A cube that slides down without friction falls freely along the plane, and feels g cos α across it.
TEST(DropObservation, SlopeCountsAlongItsNormalOnly) {
  const double slope = std::numbers::pi / 4;
  const Vec3 normal(std::sin(slope), 0, std::cos(slope));
  const DropObservation drop = observe(
      1.0, [](double t) { return 9 - 0.5 * kGravity * std::sqrt(0.5) * t * t; },
      [](double t) { return -kGravity * std::sqrt(0.5) * t; }, normal);
  EXPECT_EQ(drop.bounces, 0);
  EXPECT_NEAR(drop.distance_m, 0.0, 1e-12);
  EXPECT_LT((drop.up_in_body - normal).norm(), 1e-12);
}

TEST(DropObservation, DistanceIsAlongThePlane) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  DropObserver observer(cube, Vec3::UnitZ());
  observer.sample(0.0, {.position = {0, 0, 1}});
  observer.sample(kStep, {.position = {3, 4, 0.1}});
  EXPECT_NEAR(observer.result().distance_m, 5.0, 1e-12);
}

TEST(DropObservation, KineticEnergyOfAnEarlyEndGoesOn) {
  const DropObservation drop = observe(
      1.0, [](double) { return 0.1; }, [](double) { return 2.0; });
  ASSERT_EQ(int(drop.kinetic_energy.size()), kKineticEnergySamples);
  EXPECT_FLOAT_EQ(drop.kinetic_energy.front(), 2.0F);
  EXPECT_FLOAT_EQ(drop.kinetic_energy.back(), 2.0F);
}

TEST(DropObservation, KineticEnergyCountsRotation) {
  const Shape box = make_shape("box", make_box({0.2, 0.3, 0.4}));
  RigidState state{.velocity = {1, 2, 2}, .angular_velocity = {0, 0, 3}};
  EXPECT_NEAR(kinetic_energy(box, state), 4.5 + 0.5 * 9 * (0.04 + 0.09) / 12, 1e-12);
  state.orientation =
      Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));  // the body's y axis points up
  EXPECT_NEAR(kinetic_energy(box, state), 4.5 + 0.5 * 9 * (0.04 + 0.16) / 12, 1e-12);
}

TEST(DropObservation, SettlesAfterASecondWithoutStirring) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  DropObserver observer(cube, Vec3::UnitZ());
  observer.sample(0.0, {.velocity = {1, 0, 0}});
  for (int i = 1; i < 60; ++i) observer.sample(i * kStep, {});
  EXPECT_FALSE(observer.settled());
  observer.sample(1.0, {});
  EXPECT_TRUE(observer.settled());
}

}  // namespace
}  // namespace lodestone
