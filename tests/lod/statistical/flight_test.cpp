#include "lod/statistical/flight.h"

#include <gtest/gtest.h>

#include <vector>

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
  for (int i = 0; i < 10'000; ++i)
    small = advance_orientation(small, body.spin, *kind.shape, 1e-4).normalized();
  for (int i = 0; i < 1000; ++i) advance_flight(body, kind, Vec3::Zero(), 1e-3);
  EXPECT_LT(body.orientation.angularDistance(small), 1e-4);
}

// Half the time, an eighth of the error; about an axis of inertia it is exact.
TEST(Flight, AShortTurnIsOfSecondOrder) {
  const BodyKind kind = kind_of(make_shape("box", make_box({0.1, 0.2, 0.35})));
  const Quat from = rotation_from_vector({0.3, -0.7, 0.2});
  const auto error = [&](const Vec3& rate, double time) {
    const Vec3 spin = spin_of(from, from * rate, *kind.shape);
    Quat exact = from;
    for (int i = 0; i < 1000; ++i)
      exact = advance_orientation(exact, spin, kind, time / 1000.0).normalized();
    const OwnTurning turning = find_own_turning(from, spin, *kind.shape);
    return turned_shortly(from, turning, time).angularDistance(exact);
  };
  const Vec3 rate(5.0, -6.0, 4.0);
  EXPECT_LT(error(rate, 0.04), 0.01);
  EXPECT_NEAR(error(rate, 0.04) / error(rate, 0.02), 8.0, 1.0);
  EXPECT_LT(error({0.0, 9.0, 0.0}, 0.04), 1e-9);
}

// F11's body, turning near its middle axis: the orientation errs with the step's square.
TEST(Flight, OrientationConvergesAtSecondOrder) {
  const BodyKind kind = kind_of(make_shape("box", make_box({1.0, 2.0, 0.5})));
  const auto after_a_second = [&](int steps) {
    StatisticalBody body;
    body.spin = spin_of(body.orientation, {2.0, 3.0, 1.0}, *kind.shape);
    for (int i = 0; i < steps; ++i) advance_flight(body, kind, Vec3::Zero(), 1.0 / steps);
    return body.orientation;
  };
  const Quat truth = after_a_second(6400);
  const double coarse = after_a_second(40).angularDistance(truth),
               fine = after_a_second(160).angularDistance(truth);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, coarse / 10.0);
}

// However fast it turns and however long the steps are, about whatever axis, whole or in parts.
TEST(Flight, RotationalEnergyIsKept) {
  for (const Vec3& sides : {Vec3(0.2, 0.3, 0.4), Vec3(0.01, 0.3, 0.4), Vec3(0.1, 0.1001, 0.2)}) {
    const BodyKind kind = kind_of(make_shape("box", make_box(sides)));
    for (const double w : {0.1, 5.0, 20.0, 50.0, 500.0, 1e5})
      for (const double step : {1.0 / 600.0, 1.0 / 60.0, 1.0 / 30.0, 0.1})
        for (const Vec3& axis : {Vec3(1.0, 0.01, 0.3), Vec3(0.01, 1.0, 0.3), Vec3(0.001, 1.0, 0.001)}) {
          StatisticalBody body;
          body.spin = spin_of(body.orientation, w * axis, *kind.shape);
          const double before = kinetic_energy(body, *kind.shape);
          for (int i = 0; i < 600; ++i) {
            for (const double part : i % 2 ? std::vector{1.0} : std::vector{0.3, 0.7})
              advance_flight(body, kind, Vec3::Zero(), part * step);
            ASSERT_NEAR(kinetic_energy(body, *kind.shape) / before, 1.0, 1e-9)
                << sides.transpose() << ", " << w * axis.transpose() << ", " << step << ", " << i;
          }
        }
  }
}

// The closed form, where the great circle of steepest change reaches the energy and where only the way to a
// pole does.
TEST(Flight, TurnGivesTheEnergyThatIsAskedFor) {
  const Vec3 inverse(1.0, 2.5, 4.0);
  for (const Vec3& own : {Vec3(1.0, 0.2, 0.3), Vec3(0.3, -2.0, 0.1), Vec3(1e-3, 1.0, -1e-3),
                          Vec3(0.0, 0.0, 3.0), Vec3(0.5, 0.5, 0.5)})
    for (const double ratio : {1.0, 1.2, 2.0, 2.5, 3.0, 3.9, 4.0}) {
      const double asked = ratio * own.squaredNorm();
      const Vec3 half = turn_to_energy(own, inverse, asked);
      if (half.isZero(0.0)) {  // at a pole already, whose energy is not asked for: no way leads from there
        EXPECT_TRUE(own.x() == 0.0 || std::abs(own.dot(inverse.cwiseProduct(own)) - asked) < 1e-12 * asked)
            << own.transpose() << ", " << ratio;
        continue;
      }
      const Vec3 turned = Quat(1.0, half.x(), half.y(), half.z()).normalized() * own;
      EXPECT_NEAR(turned.dot(inverse.cwiseProduct(turned)) / asked, 1.0, 1e-9)
          << own.transpose() << ", " << ratio;
      EXPECT_NEAR(turned.norm(), own.norm(), 1e-12);
    }
}

}  // namespace
}  // namespace lodestone
