#include "lod/statistical/flight.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

BodyKind kind_of(Shape shape) {
  BodyKind kind;
  kind.shape = std::make_shared<const Shape>(std::move(shape));
  return kind;
}

// S12
TEST(Flight, CentreOfMassFollowsTheParabolaExactly) {
  const BodyKind kind = kind_of(make_shape("box", make_box({0.1, 0.2, 0.3})));
  StatisticalBody body;
  body.velocity = {1.0, -2.0, 3.0};
  const Vec3 gravity(0, 0, -9.81), start = body.position, velocity = body.velocity;
  for (int i = 0; i < 600; ++i) advance_flight(body, kind, gravity, 1.0 / 60.0);
  EXPECT_LT((body.position - (start + 10.0 * velocity + 50.0 * gravity)).norm(), 1e-10);
}

TEST(Flight, KeepsAngularMomentumAndUnitNorm) {
  const BodyKind kind = kind_of(make_shape("box", make_box({0.1, 0.2, 0.3})));
  StatisticalBody body;
  body.spin = spin_of(body.orientation, {3.0, 9.0, -2.0}, *kind.shape);
  const Vec3 spin = body.spin;
  for (int i = 0; i < 100'000; ++i) advance_flight(body, kind, Vec3::Zero(), 1.0 / 60.0);
  EXPECT_EQ((body.spin - spin).norm(), 0.0);
  EXPECT_NEAR(body.orientation.norm(), 1.0, 1e-12);
}

// F11's body, turning near its middle axis: the energy wanders with the step's square and no trend.
TEST(Flight, RotationalEnergyConvergesAtSecondOrder) {
  const BodyKind kind = kind_of(make_shape("box", make_box({1.0, 2.0, 0.5})));
  const auto worst_change = [&](double step) {
    StatisticalBody body;
    body.spin = spin_of(body.orientation, {9.99, 0.3, 0.2}, *kind.shape);
    const double before = kinetic_energy(body, *kind.shape);
    double worst = 0.0;
    for (double t = 0.0; t < 2.0; t += step) {
      advance_flight(body, kind, Vec3::Zero(), step);
      worst = std::max(worst, std::abs(kinetic_energy(body, *kind.shape) / before - 1.0));
    }
    return worst;
  };
  const double coarse = worst_change(1.0 / 60.0), fine = worst_change(1.0 / 240.0);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, coarse / 10.0);
}

}  // namespace
}  // namespace lodestone
