// Held to the solver of many bodies, which does the same in the world's axes.
#include "lod/contact/ground_solver.h"

#include <gtest/gtest.h>

#include "reference/free_rotation.h"
#include "reference/random.h"
#include "reference/shape.h"
#include "tests/lod/contact/plain_solver.h"

namespace lodestone::ground_solver_test {
namespace {

constexpr double kStep = 1.0 / 60;

struct Corners {
  std::array<SolverBody, 1> bodies;
  std::array<PlainContact, 4> in_world;
  GroundMotion motion;
  std::array<GroundContact, 4> in_body;
};

// A box that comes down on four corners, somehow.
Corners make_corners(const Shape& box, const Quat& orientation, std::uint32_t number) {
  RandomStream random(5, number, 0);
  Corners corners;
  const Vec3 velocity = random.uniform(0, 3) * random.direction(),
             omega = random.uniform(0, 9) * random.direction(), normal = random.direction();
  corners.bodies[0] = {velocity, omega, 1.0, inverse_inertia_world(orientation, box)};
  corners.motion = {orientation.conjugate() * velocity, orientation.conjugate() * omega};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 arm = random.uniform(0.05, 0.2) * random.direction(), guess = random.uniform(0, 1) * normal;
    const double gap = random.uniform(-0.002, 0.01);
    const ContactLaw law{.restitution = 0.4, .friction = 0.6};
    corners.in_world[i] = {.normal = normal, .arm_first = arm, .gap = gap, .law = law, .guess = guess};
    corners.in_body[i] = {.normal = orientation.conjugate() * normal,
                          .arm = orientation.conjugate() * arm,
                          .gap = gap,
                          .law = law,
                          .guess = orientation.conjugate() * guess};
  }
  return corners;
}

TEST(GroundSolver, InTheBodysAxesItDoesWhatTheOtherDoesInTheWorlds) {
  const Shape box = make_shape("box", make_box({0.2, 0.3, 0.4}));
  for (const bool frictionless_bound : {false, true})
    for (std::uint32_t i = 0; i < 100; ++i) {
      RandomStream random(6, i, 0);
      const Quat orientation = random.orientation();
      Corners c = make_corners(box, orientation, i);
      const ContactSolverSettings settings{
          .sweeps = 8, .tolerance = 0.0, .frictionless_bound = frictionless_bound};
      solve_plainly(c.bodies, c.in_world, kStep, settings);
      solve_ground_contacts(c.motion, box.inverse_inertia_per_mass, c.in_body, kStep, settings);
      EXPECT_LT((orientation * c.motion.velocity - c.bodies[0].velocity).norm(), 1e-9) << i;
      EXPECT_LT((orientation * c.motion.angular_velocity - c.bodies[0].angular_velocity).norm(), 1e-8) << i;
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_LT((orientation * c.in_body[k].impulse() - c.in_world[k].impulse()).norm(), 1e-9) << i;
        EXPECT_EQ(c.in_body[k].bounces, c.in_world[k].bounces) << i;
      }
    }
}

// Of blows that lose nothing up to a third was lost where a body spun.
TEST(GroundSolver, AlongChordsWhatBouncesLeavesAsFastAsItCame) {
  const Shape box = make_shape("box", make_box({0.1, 0.2, 0.35}));
  for (std::uint32_t i = 0; i < 20; ++i) {
    RandomStream random(8, i, 0);
    GroundMotion motion{Vec3(random.uniform(-3, 3), random.uniform(-3, 3), -8), 30.0 * random.direction()};
    const GroundMotion before = motion;
    std::array contacts{GroundContact{.normal = Vec3::UnitZ(),
                                      .arm = Vec3(random.uniform(-0.05, 0.05), 0.1, -0.17),
                                      .gap = 0.0,
                                      .law = {.restitution = 1.0, .friction = 0.0}}};
    solve_ground_contacts(motion, box.inverse_inertia_per_mass, contacts, kStep, {.along_chords = true});
    ASSERT_TRUE(contacts[0].bounces);
    EXPECT_NEAR(motion.velocity_at(contacts[0].arm).z(), -before.velocity_at(contacts[0].arm).z(), 1e-9);
  }
}

// A cube that turns about its lowest corner, gravity pressing it down, in axes that are its own where the
// step begins.
TEST(GroundSolver, AlongChordsAContactKeepsItsPlace) {
  const Shape cube = make_shape("cube", make_box({0.2, 0.2, 0.2}));
  const Vec3 arm(-0.03, 0.02, -0.15), omega(2.0, 7.0, -3.0);  // m, 1/s
  constexpr double kTime = 0.01;                              // s
  for (const bool along_chords : {false, true}) {
    GroundMotion motion{-omega.cross(arm) - Vec3(0, 0, 9.81 * kTime), omega};
    std::array<GroundContact, 1> contact{{{.arm = arm, .law = {.restitution = 0.0, .friction = 10.0}}}};
    solve_ground_contacts(motion, cube.inverse_inertia_per_mass, contact, kTime,
                          {.sweeps = 100, .tolerance = 1e-12, .along_chords = along_chords});
    const Quat turned = rotation_from_vector(motion.angular_velocity * kTime);
    const double moved = (motion.velocity * kTime + turned * arm - arm).norm();
    if (along_chords)
      EXPECT_LT(moved, 2e-5);
    else
      EXPECT_GT(moved, 2e-4);
  }
}

// A needle that spins about itself, an end on the ground: its angular velocity turns by as much as it does,
// and the end does not go round with the one that it has at first. Needles were thrown off with eight times
// their energy.
TEST(GroundSolver, WhatTurnsTooFarInAStepKeepsNoPlace) {
  const Shape needle = make_shape("needle", make_needle(0.2, 0.002));
  const auto energy = [&](const GroundMotion& m) {  // J/kg
    return 0.5 *
           (m.velocity.squaredNorm() + m.angular_velocity.dot(needle.inertia_per_mass * m.angular_velocity));
  };
  for (const double spin : {-600.0, -400.0, 400.0, 600.0}) {  // rad/s
    GroundMotion motion{Vec3::Zero(), Vec3(20.0, 0, spin)};
    const GroundMotion before = motion;
    std::array contacts{
        GroundContact{.normal = Vec3::UnitX(), .arm = Vec3(-0.002, 0, 0.1), .law = {.friction = 0.0}}};
    solve_ground_contacts(motion, needle.inverse_inertia_per_mass, contacts, 0.0065, {.along_chords = true});
    EXPECT_LE(energy(motion), 1.001 * energy(before)) << spin;
  }
}

// What is slender turns so easily about its own axis that an impulse along one way moves a point nearly as
// much along the two others: blades were thrown off, at a friction of .5 with up to four times their energy.
TEST(GroundSolver, APointOfASlenderBodyGainsNothing) {
  const Vec3 inverse_moments(100, 120, 3000);  // 1/m²
  for (const double friction : {0.5, 1.0, 1e6})
    for (const bool frictionless_bound : {false, true})
      for (std::uint32_t i = 0; i < 300; ++i) {
        RandomStream random(9, i, 0);
        const Mat3 axes = random.orientation().toRotationMatrix(),
                   inverse_inertia = axes * inverse_moments.asDiagonal() * axes.transpose();
        const Vec3 velocity = random.direction(), axis = random.direction(), normal = random.direction(),
                   arm = random.direction();
        GroundMotion motion{random.uniform(0, 2) * velocity, random.uniform(0, 5) * axis};
        const auto energy = [&] {  // J/kg
          return 0.5 * (motion.velocity.squaredNorm() +
                        motion.angular_velocity.dot(inverse_inertia.inverse() * motion.angular_velocity));
        };
        const double before = energy();
        std::array contacts{GroundContact{
            .normal = normal, .arm = 0.1 * arm, .law = {.restitution = 0.0, .friction = friction}}};
        solve_ground_contacts(motion, inverse_inertia, contacts, kStep,
                              {.sweeps = 20, .frictionless_bound = frictionless_bound});
        EXPECT_LT(energy(), 1.001 * before) << friction << ' ' << frictionless_bound << ' ' << i;
      }
}

}  // namespace
}  // namespace lodestone::ground_solver_test
