// The bounds of friction, and an impact in a fall; the solver's crowds are in crowd_solver_test.cpp.
#include "lod/contact/contact_solver.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "lod/contact/crowd_solver.h"
#include "lod/contact/ground_solver.h"

namespace lodestone {
namespace {

constexpr double kFriction = 0.4;

const Mat3 kInverseInertia = 150.0 * Mat3::Identity();

// A body of 1 kg that slides along x onto a point ahead of and below its middle: friction there turns it into
// the ground.
GroundContact solve_sliding(double friction, bool frictionless_bound) {
  GroundMotion motion{.velocity = {3, 0, -1}};
  std::array<GroundContact, 1> contacts{
      GroundContact{.arm = {0.1, 0, -0.1}, .law = {.restitution = 0.0, .friction = friction}}};
  solve_ground_contacts(motion, kInverseInertia, contacts, 1e-9,
                        {.sweeps = 500, .tolerance = 0.0, .frictionless_bound = frictionless_bound});
  return contacts[0];
}

double along_ground(const GroundContact& c) { return std::hypot(c.rows[1].impulse, c.rows[2].impulse); }

TEST(ContactSolver, FrictionIsBoundedByTheNormalImpulseAsItIs) {
  const GroundContact bare = solve_sliding(0.0, false), rubbed = solve_sliding(kFriction, false);
  EXPECT_GT(rubbed.rows[0].impulse, 1.1 * bare.rows[0].impulse);  // friction presses it down
  EXPECT_NEAR(along_ground(rubbed), kFriction * rubbed.rows[0].impulse, 1e-9);
}

// As dWorldStep with dContactApprox1 has it.
TEST(ContactSolver, TheFrictionlessBoundIsThatOfTheNormalImpulseWithoutFriction) {
  const GroundContact bare = solve_sliding(0.0, false), rubbed = solve_sliding(kFriction, true);
  EXPECT_GT(rubbed.rows[0].impulse, 1.1 * bare.rows[0].impulse);
  EXPECT_NEAR(along_ground(rubbed), kFriction * bare.rows[0].impulse, 1e-9);
  EXPECT_LT(along_ground(rubbed), 0.95 * kFriction * rubbed.rows[0].impulse);
}

TEST(ContactSolver, WithEitherBoundNothingMovesIntoTheGroundAfterwards) {
  for (const bool frictionless_bound : {false, true}) {
    GroundMotion motion{.velocity = {3, 1, -1}, .angular_velocity = {2, -1, 4}};
    std::array<GroundContact, 3> contacts;
    for (std::size_t i = 0; i < 3; ++i)
      contacts[i] = {.arm = {0.1 * std::cos(2.1 * double(i)), 0.1 * std::sin(2.1 * double(i)), -0.1},
                     .law = {.restitution = 0.0, .friction = kFriction}};
    solve_ground_contacts(motion, kInverseInertia, contacts, 1e-9,
                          {.sweeps = 2000, .tolerance = 0.0, .frictionless_bound = frictionless_bound});
    for (const GroundContact& c : contacts)
      EXPECT_GT((motion.velocity + motion.angular_velocity.cross(c.arm)).z(), -1e-9);
  }
}

// One sweep is enough where the impulses with and without friction are known, and else it is not: friction
// turns the body onto the points ahead, which carry less without it.
TEST(ContactSolver, BeginsWithTheFrictionlessImpulsesOfTheLastStep) {
  const std::vector<CrowdManifold> manifolds{
      {.first = 0, .law = {.restitution = 0.0, .friction = kFriction}, .begin = 0, .count = 2}};
  const std::vector<CrowdPoint> start{{.arm_first = {0.1, 0.06, -0.1}}, {.arm_first = {0.06, -0.1, -0.1}}};
  constexpr double kConverged = 0.0, kOneSweep = 1e9;
  const auto solve = [&](std::vector<CrowdPoint>& points, double tolerance) {
    std::vector<SolverBody> bodies{
        SolverBody{.velocity = {3, 0, -1}, .inverse_mass = 1.0, .inverse_inertia = kInverseInertia}};
    CrowdSolver().solve(bodies, manifolds, points, 1e-9,
                        {.sweeps = 2000, .tolerance = tolerance, .bounce_velocity = 10.0},
                        make_job_runner(1));
    return bodies[0].velocity;
  };
  std::vector<CrowdPoint> solved = start;
  const Vec3 converged = solve(solved, kConverged);
  std::vector<CrowdPoint> known = start, unknown = start;
  for (std::size_t i = 0; i < 2; ++i) {
    known[i].guess = unknown[i].guess = solved[i].impulse;
    known[i].frictionless = solved[i].frictionless;
  }
  EXPECT_LT((solve(known, kOneSweep) - converged).norm(), 1e-4);  // floats
  EXPECT_GT((solve(unknown, kOneSweep) - converged).norm(), 1e-3);
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
