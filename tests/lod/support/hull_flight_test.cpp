#include "lod/support/hull_flight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/random.h"

namespace lodestone::hull_flight_test {
namespace {

constexpr double kGravity = 9.81, kStep = 1.0 / 60;

// A box over the plane z = 0.
class HullFlightOfBox : public ::testing::Test {
 protected:
  HullFlightOfBox() {
    world_.gravity = {0, 0, -kGravity};
    world_.planes = planes_;
  }
  double radius() const { return kind_.shape->radius; }
  double gap(const HullFlight& flight, double time) const {
    std::int32_t hint = 0;
    return flight.find_lowest(flight.pose_at(time), hint).gap;
  }
  Impact end_of(const HullFlight& flight, std::int32_t& hint) const {
    Impact end{kStep, flight.pose_at(kStep), {}};
    end.lowest = flight.find_lowest(end.pose, hint);
    return end;
  }
  // Just over the ground, coming down, turning any way.
  StatisticalBody falling(std::uint32_t number) const {
    RandomStream random(21, number, 0);
    StatisticalBody body;
    body.orientation = random.orientation();
    body.velocity = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-5, -1)};
    body.spin = spin_of(body.orientation, random.uniform(0, 25) * random.direction(), *kind_.shape);
    const int low = find_support(kind_.shape->hull, body.orientation.conjugate() * Vec3(0, 0, -1));
    const Vec3 arm = body.orientation * kind_.shape->hull.vertices[std::size_t(low)];
    body.position = {0, 0, -arm.z() + random.uniform(0.001, 0.02)};
    return body;
  }

  BodyKind kind_ =
      make_body_kind(std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4}))));
  std::vector<HalfSpace> planes_ = {HalfSpace()};
  StepWorld world_;
};

TEST_F(HullFlightOfBox, AFlatFallStrikesWhenItsParabolaDoes) {
  StatisticalBody body;
  body.position = {0, 0, 0.2 + 0.01};
  body.velocity = {3, 0, -1.5};
  const HullFlight flight(body, kind_, world_);
  std::int32_t hint = 0;
  const Impact impact = flight.find_impact(end_of(flight, hint), 1e-9, hint);
  EXPECT_NEAR(impact.time, (-1.5 + std::sqrt(1.5 * 1.5 + 2.0 * kGravity * 0.01)) / kGravity, 1e-8);
  EXPECT_NEAR(impact.pose.position.z(), 0.2, 1e-8);
}

TEST_F(HullFlightOfBox, AnImpactOfATurningBodyIsWhereItsGapCloses) {
  int struck = 0;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const StatisticalBody body = falling(i);
    const HullFlight flight(body, kind_, world_);
    std::int32_t hint = 0;
    const Impact end = end_of(flight, hint);
    if (end.lowest.gap >= 0.0) continue;
    ++struck;
    const double tolerance = 1e-4 * radius();
    const Impact impact = flight.find_impact(end, tolerance, hint);
    EXPECT_NEAR(gap(flight, impact.time), 0.0, 1.001 * tolerance) << i;
    EXPECT_LT(flight.gap_motion(impact.pose, impact.lowest, impact.time).velocity, 0.0) << i;
  }
  EXPECT_GT(struck, 200);
}

TEST_F(HullFlightOfBox, AGapMovesAsItsDerivativesSay) {
  constexpr double kApart = 1e-4;  // s
  for (std::uint32_t i = 0; i < 50; ++i) {
    const StatisticalBody body = falling(i);
    const HullFlight flight(body, kind_, world_);
    const double time = 0.5 * kStep;
    std::int32_t hint = 0;
    const HullPose pose = flight.pose_at(time);
    const LowestPoint lowest = flight.find_lowest(pose, hint);
    const auto height = [&](double at) {  // of that point
      const HullPose p = flight.pose_at(at);
      return p.position.z() + (p.orientation * lowest.arm).z();
    };
    const GapMotion motion = flight.gap_motion(pose, lowest, time);
    const double before = height(time - kApart), now = height(time), after = height(time + kApart);
    EXPECT_NEAR(motion.velocity, (after - before) / (2.0 * kApart), 5e-3) << i;
    EXPECT_NEAR(motion.acceleration, (after - 2.0 * now + before) / (kApart * kApart), 0.5) << i;
  }
}

TEST_F(HullFlightOfBox, WhatLiesInTheGroundFromTheStartStrikesAtOnce) {
  StatisticalBody body;
  body.position = {0, 0, 0.2 - 0.001};
  body.velocity = {0, 0, -2};
  const HullFlight flight(body, kind_, world_);
  std::int32_t hint = 0;
  EXPECT_EQ(flight.find_impact(end_of(flight, hint), 1e-4 * radius(), hint).time, 0.0);
}

}  // namespace
}  // namespace lodestone::hull_flight_test
