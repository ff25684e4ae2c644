// The bounds of friction, and an impact in a fall; the solver's crowds are in crowd_solver_test.cpp.
#include "lod/contact/contact_solver.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace lodestone {
namespace {

constexpr double kFriction = 0.4;

// A body of 1 kg that slides along x onto a point ahead of and below its middle: friction there turns it into
// the ground.
SolverContact solve_sliding(double friction, bool frictionless_bound) {
  std::array<SolverBody, 1> bodies{
      SolverBody{.velocity = {3, 0, -1}, .inverse_mass = 1.0, .inverse_inertia = 150.0 * Mat3::Identity()}};
  std::array<SolverContact, 1> contacts{
      SolverContact{.arm_first = {0.1, 0, -0.1}, .law = {.restitution = 0.0, .friction = friction}}};
  solve_contacts(bodies, contacts, 1e-9,
                 {.sweeps = 500, .tolerance = 0.0, .frictionless_bound = frictionless_bound});
  return contacts[0];
}

double along_ground(const SolverContact& c) { return std::hypot(c.impulse[1], c.impulse[2]); }

TEST(ContactSolver, FrictionIsBoundedByTheNormalImpulseAsItIs) {
  const SolverContact bare = solve_sliding(0.0, false), rubbed = solve_sliding(kFriction, false);
  EXPECT_GT(rubbed.impulse[0], 1.1 * bare.impulse[0]);  // friction presses it down
  EXPECT_NEAR(along_ground(rubbed), kFriction * rubbed.impulse[0], 1e-9);
}

// As dWorldStep with dContactApprox1 has it.
TEST(ContactSolver, TheFrictionlessBoundIsThatOfTheNormalImpulseWithoutFriction) {
  const SolverContact bare = solve_sliding(0.0, false), rubbed = solve_sliding(kFriction, true);
  EXPECT_GT(rubbed.impulse[0], 1.1 * bare.impulse[0]);
  EXPECT_NEAR(along_ground(rubbed), kFriction * bare.impulse[0], 1e-9);
  EXPECT_LT(along_ground(rubbed), 0.95 * kFriction * rubbed.impulse[0]);
}

TEST(ContactSolver, WithEitherBoundNothingMovesIntoTheGroundAfterwards) {
  for (const bool frictionless_bound : {false, true}) {
    std::array<SolverBody, 1> bodies{SolverBody{.velocity = {3, 1, -1},
                                                .angular_velocity = {2, -1, 4},
                                                .inverse_mass = 1.0,
                                                .inverse_inertia = 150.0 * Mat3::Identity()}};
    std::array<SolverContact, 3> contacts;
    for (std::size_t i = 0; i < 3; ++i)
      contacts[i] = {.arm_first = {0.1 * std::cos(2.1 * double(i)), 0.1 * std::sin(2.1 * double(i)), -0.1},
                     .law = {.restitution = 0.0, .friction = kFriction}};
    solve_contacts(bodies, contacts, 1e-9,
                   {.sweeps = 2000, .tolerance = 0.0, .frictionless_bound = frictionless_bound});
    for (const SolverContact& c : contacts)
      EXPECT_GT((bodies[0].velocity + bodies[0].angular_velocity.cross(c.arm_first)).z(), -1e-9);
  }
}

// One sweep is enough where the impulses with and without friction are known, and else it is not: friction
// turns the body onto the points ahead, which carry less without it.
TEST(ContactSolver, BeginsWithTheFrictionlessImpulsesOfTheLastStep) {
  const SolverBody start{
      .velocity = {3, 0, -1}, .inverse_mass = 1.0, .inverse_inertia = 150.0 * Mat3::Identity()};
  std::array<SolverContact, 2> contacts;
  contacts[0].arm_first = {0.1, 0.06, -0.1}, contacts[1].arm_first = {0.06, -0.1, -0.1};
  for (SolverContact& c : contacts) c.law = {.restitution = 0.0, .friction = kFriction};
  const auto solve = [&](std::array<SolverContact, 2>& of, int sweeps) {
    std::array<SolverBody, 1> bodies{start};
    solve_contacts(bodies, of, 1e-9,
                   {.sweeps = sweeps, .tolerance = 0.0, .frictionless_bound = true, .bounce_velocity = 10.0});
    return bodies[0].velocity;
  };
  std::array<SolverContact, 2> solved = contacts;
  const Vec3 converged = solve(solved, 2000);
  for (std::size_t i = 0; i < 2; ++i) contacts[i].guess = impulse_of(solved[i]);
  std::array<SolverContact, 2> unknown = contacts;
  for (std::size_t i = 0; i < 2; ++i) contacts[i].frictionless = solved[i].frictionless;
  EXPECT_LT((solve(contacts, 1) - converged).norm(), 1e-9);
  EXPECT_GT((solve(unknown, 1) - converged).norm(), 1e-3);
}

// Dropped from rest h above the ground, it is there within the step, bounces, and falls on: v² = 2 g h.
TEST(ContactSolver, AnImpactWithinAStepIsAnsweredAtItsOwnTime) {
  constexpr double kGravity = 9.81, kStep = 1.0 / 60, kGap = 2e-4, kRestitution = 0.6;
  const double hit = std::sqrt(2.0 * kGravity * kGap), left = kStep - hit / kGravity;
  const double fall = -kGravity * kStep;  // all of its approach
  EXPECT_NEAR(bounce_in_fall(kRestitution, kGap, fall, fall, kStep), kRestitution * hit - kGravity * left,
              1e-12);
}

}  // namespace
}  // namespace lodestone
