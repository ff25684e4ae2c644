#include "lod/statistical/flight.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

BodyKind kind_of(Shape shape) { return make_body_kind(std::make_shared<const Shape>(std::move(shape))); }

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

// A needle that spins about its length at 300 rad/s, five radians a step, keeps its energy.
TEST(Flight, SlenderBodiesKeepTheirEnergyHoweverFastTheySpin) {
  const BodyKind kind = kind_of(make_shape("needle", make_needle(0.4, 0.01)));
  StatisticalBody body;
  body.orientation = rotation_from_vector({0.3, -0.7, 0.2});
  body.spin = spin_of(body.orientation, body.orientation * Vec3(4.0, 7.0, 300.0), *kind.shape);
  const double before = kinetic_energy(body, *kind.shape);
  for (int i = 0; i < 6000; ++i) {
    advance_flight(body, kind, Vec3::Zero(), 1.0 / 60.0);
    ASSERT_NEAR(kinetic_energy(body, *kind.shape) / before, 1.0, 1e-6) << i;
  }
}

// What the splitting gives is the motion that small steps converge to, whatever the axes of the mesh.
TEST(Flight, AgreesWithSmallStepsOfAnotherRule) {
  Mesh mesh = make_box({0.1, 0.2, 0.35});
  for (Vec3& v : mesh.vertices) v = rotation_from_vector({0.4, 0.9, -0.3}) * v;
  const BodyKind kind = kind_of(make_shape("turned box", mesh));
  StatisticalBody body;
  body.spin = spin_of(body.orientation, {5.0, -6.0, 4.0}, *kind.shape);
  Quat small = body.orientation;
  for (int i = 0; i < 10'000; ++i) small = advance_orientation(small, body.spin, *kind.shape, 1e-4).normalized();
  for (int i = 0; i < 1000; ++i) advance_flight(body, kind, Vec3::Zero(), 1e-3);
  EXPECT_LT(body.orientation.angularDistance(small), 1e-4);
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
