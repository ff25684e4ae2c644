// Boxes that stand on an edge and are let go: they turn about it as a pendulum does, however near to balance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

/// s: until a box of `sides` (m), on an edge along y and let go `from` rad beyond lying flat, has turned to
/// `to`.
double time_of_pendulum(const Vec3& sides, double from, double to) {
  constexpr double kStep = 1e-5;  // s
  const double arm = 0.5 * std::hypot(sides.x(), sides.z()), balance = std::atan(sides.x() / sides.z()),
               inertia = (sides.x() * sides.x() + sides.z() * sides.z()) / 12.0 + arm * arm;  // m²
  double angle = from, speed = 0.0, time = 0.0;
  for (; (to - from) * (to - angle) > 0.0 && time < 10.0; time += kStep) {
    speed += kStep * kGravity * arm / inertia * std::sin(angle - balance);
    angle += kStep * speed;
  }
  return time;
}

/// The same of a body of `support`.
double time_of_body(const Vec3& sides, double from, double to, double frame) {
  Manager manager = on_floor();
  manager.materials().replace(0, {.restitution = 0.3, .friction = 0.6});
  RigidState state{.orientation = Quat(Eigen::AngleAxisd(from, Vec3::UnitY()))};
  state.position.z() = 0.5 * (sides.x() * std::sin(from) + sides.z() * std::cos(from));
  const BodyId box = add(manager, box_shape(sides), state, LevelChoice::support);
  double before = from;
  for (int i = 1; i * frame < 10.0; ++i) {
    manager.step(frame);
    const Vec3 side = manager.state(box).orientation * Vec3::UnitX();
    const double angle = std::atan2(-side.z(), side.x());
    if ((to - from) * (to - angle) <= 0.0) return (i - (angle - to) / (angle - before)) * frame;
    before = angle;
  }
  return 10.0;
}

TEST(Leaning, WhatIsPastBalanceFallsAndWhatIsNotFallsBack) {
  for (const Vec3& sides : {Vec3(0.1, 0.1, 0.8), Vec3(0.3, 1, 3), Vec3(0.04, 0.2, 0.8), Vec3(0.03, 0.1, 0.2)})
    for (const double frame : {1.0 / 60, 1.0 / 240}) {
      const double balance = std::atan(sides.x() / sides.z());
      for (const double share : {0.5, 0.8, 1.2}) {
        const double from = share * balance, to = share < 1.0 ? 0.1 * from : 20.0 / 180.0 * std::numbers::pi,
                     expected = time_of_pendulum(sides, from, to);
        EXPECT_NEAR(time_of_body(sides, from, to, frame), expected, 0.03 * expected + 0.005)
            << sides.transpose() << " at " << share << " of balance, " << 1.0 / frame << " Hz";
      }
    }
}

// m: how far along the ground a cube ends from where it was let go, on an edge.
double slip(double friction, double tilt, LevelChoice level) {
  constexpr double kEdge = 0.2;  // m
  ManagerSettings settings = unmeasured();
  settings.full_substeps = 16;
  Manager manager = on_floor(settings);
  manager.materials().replace(0, {.restitution = 0.3, .friction = friction});
  RigidState state{.orientation = Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()))};
  state.position.z() = 0.5 * kEdge * (std::sin(tilt) + std::cos(tilt));
  const BodyId cube = add(manager, box_shape({kEdge, kEdge, kEdge}), state, level);
  run(manager, 2.0);
  return manager.state(cube).position.x() - state.position.x();
}

// dWorldStep bounds friction by what the normal impulses were without any.
TEST(Leaning, TheEdgeSlipsAsInOde) {
  for (const double friction : {0.3, 0.4, 0.6, 0.8})
    for (const double tilt : {0.35, 0.6}) {
      const double expected = slip(friction, tilt, LevelChoice::full);
      EXPECT_NEAR(slip(friction, tilt, LevelChoice::support), expected, 0.15 * std::abs(expected) + 0.002)
          << friction << " from " << tilt;
    }
}

}  // namespace
}  // namespace lodestone
