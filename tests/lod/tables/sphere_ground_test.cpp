#include "lod/tables/sphere_ground.h"

#include <gtest/gtest.h>

#include "tests/lod/tables/sphere_fixture.h"

namespace lodestone::sphere_ground_test {
namespace {

using testing::at;
using testing::box_shape;
using testing::kGravity;

constexpr double kStep = 1.0 / 60.0;
constexpr double kFriction = 0.5;

// A cube whose sphere touches the plane, on which gravity presses with `pressure`.
struct OnPlane : testing::SphereScene {
  explicit OnPlane(const RigidState& state, const HalfSpace& floor = {}, double friction = kFriction,
                   double gap = 0.0)
      : SphereScene(kStep), plane(floor), materials(ContactLaw{0.4, friction}) {
    RigidState placed = state;
    placed.position = (floor.offset + cube->radius + gap) * floor.normal;
    add(cube, 1.0, placed);
    ground.clear(dense.size());
    ground.add(plane, materials, dense, {0, 0, -kGravity});
  }
  void lie(bool among_others, float held = 0.0f) {
    start();
    find_near_ground(spheres, dense, ground, plane, 0, constants, Simd::portable, 0, 1, step);
    if (among_others) step.p[0].w = 1.0f, spheres.held[0] = held;
    sort_near_ground(spheres, dense, ground, constants, 0.05f, Simd::portable, 0, 1, step);
    lie_on_ground(spheres, dense, ground, constants, Simd::portable, 0, 1, step);
  }
  GroundState state() const { return GroundState(step.on_ground[0]); }
  Vec3 velocity() const { return step.velocity(0); }
  Vec3 spin() const { return spheres.spin(0) + step.added_spin(0); }

  std::shared_ptr<const Shape> cube = box_shape({0.2, 0.2, 0.2});
  HalfSpace plane;
  MaterialTable materials;
  SphereGround ground;
};

// Whether it gets there within the step: gap < v t + ½ g t², with a thousandth of that and 2 ‰ of its radius
// to spare.
TEST(SphereGround, NearIsWhatMayMeetThePlaneInThisStep) {
  const double way = 3.0 * kStep + 0.5 * kGravity * kStep * kStep;
  for (const auto& [gap, near] :
       {std::pair{-0.1, true}, {0.0, true}, {0.999 * way, true}, {1.02 * way, false}}) {
    OnPlane scene(at({0, 0, 0}, {1, 0, -3}), {}, kFriction, gap);
    scene.start();
    find_near_ground(scene.spheres, scene.dense, scene.ground, scene.plane, 0, scene.constants,
                     Simd::portable, 0, 1, scene.step);
    EXPECT_EQ(scene.state(), near ? GroundState::near : GroundState::free) << gap;
    if (near) {
      EXPECT_NEAR(scene.step.gap[0], gap, 1e-6);
    }
  }
}

TEST(SphereGround, OfTwoPlanesThatIsTakenWhichGravityPressesOn) {
  const HalfSpace wall{Vec3::UnitX(), 0.0}, floor{};
  for (const bool wall_first : {true, false}) {
    OnPlane scene(at({0, 0, 0}), wall_first ? wall : floor);
    scene.ground.add(wall_first ? floor : wall, scene.materials, scene.dense, {0, 0, -kGravity});
    scene.spheres.x[0] = scene.spheres.z[0] = scene.cube->radius;
    scene.start();
    for (int number = 0; number < 2; ++number)
      find_near_ground(scene.spheres, scene.dense, scene.ground, (number == 0) == wall_first ? wall : floor,
                       number, scene.constants, Simd::portable, 0, 1, scene.step);
    EXPECT_EQ(scene.step.plane[0], wall_first ? 1 : 0);
  }
  // Of two that gravity presses on alike, the nearer.
  OnPlane steps(at({0, 0, 0}));
  const HalfSpace higher{Vec3::UnitZ(), 0.01};
  steps.ground.add(higher, steps.materials, steps.dense, {0, 0, -kGravity});
  steps.start();
  find_near_ground(steps.spheres, steps.dense, steps.ground, steps.plane, 0, steps.constants, Simd::portable,
                   0, 1, steps.step);
  find_near_ground(steps.spheres, steps.dense, steps.ground, higher, 1, steps.constants, Simd::portable, 0, 1,
                   steps.step);
  EXPECT_EQ(steps.step.plane[0], 1);
  EXPECT_NEAR(steps.step.gap[0], -0.01, 1e-6);
}

TEST(SphereGround, AnImpactIsLeftToTheTables) {
  OnPlane scene(at({0, 0, 0}, {0, 0, -0.06}));
  scene.lie(true);
  EXPECT_EQ(scene.state(), GroundState::near);
  OnPlane slow(at({0, 0, 0}, {0, 0, -0.04}));
  slow.lie(true);
  EXPECT_EQ(slow.state(), GroundState::settles);
}

// Alone and under the resting conditions: μ g t off its speed, as far as that is there.
TEST(SphereGround, SlidingLosesFrictionTimesGravity) {
  OnPlane scene(at({0, 0, 0}, {0.3, 0.4, 0}));
  scene.spheres.motion[0] = Motion::settling;
  scene.lie(false);
  EXPECT_EQ(scene.state(), GroundState::lies);
  const double left = 0.5 - kFriction * kGravity * kStep;
  EXPECT_LT((scene.velocity() - Vec3(0.6 * left, 0.8 * left, 0)).norm(), 1e-6);
}

// So slow that friction ends the slip within the step: then it rolls, v + ω × (−r n) = 0.
TEST(SphereGround, WhatFrictionCanStopRolls) {
  OnPlane scene(at({0, 0, 0}, {0.05, 0, 0}));
  scene.spheres.motion[0] = Motion::settling;
  scene.lie(false);
  const Vec3 omega = scene.cube->inverse_inertia_per_mass * scene.spin(), v = scene.velocity();
  const Vec3 slip = v + omega.cross(Vec3(0, 0, -scene.cube->radius));
  EXPECT_LT(Vec3(slip.x(), slip.y(), 0).norm(), 1e-6);
  EXPECT_GT(v.x(), 0.01);
  EXPECT_LT(v.x(), 0.05);
}

// The torque about the normal that brakes it is at most .3 R μ times the normal impulse.
TEST(SphereGround, PivotingIsBrakedByTheFootprint) {
  const float held = float(kGravity * kStep);
  OnPlane fast(at({0, 0, 0}, {0, 0, 0}, {0, 0, 40}));
  const double before = fast.spin().z();
  fast.lie(true, held);
  EXPECT_NEAR(before - fast.spin().z(), 0.3 * fast.cube->radius * kFriction * double(held), 1e-6);
  OnPlane slow(at({0, 0, 0}, {0, 0, 0}, {0, 0, 0.01}));
  slow.lie(true, held);
  EXPECT_NEAR(slow.spin().z(), 0.0, 1e-9);
}

// Slower by the root of the energy there is over what that takes, but never by less than .25 rad.
TEST(SphereGround, ItTurnsIntoItsRestPoseInTheBlendTime) {
  const double angle = 1.0;
  const Quat tilted = rotation_from_vector(Vec3(0, angle, 0));
  OnPlane scene(at({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, tilted), {}, 0.0);
  scene.spheres.motion[0] = Motion::settling;
  scene.start();
  find_near_ground(scene.spheres, scene.dense, scene.ground, scene.plane, 0, scene.constants, Simd::portable,
                   0, 1, scene.step);
  const double rate = angle / double(scene.dense.blend_time[0]);
  const double cost = 0.5 * scene.cube->inertia_per_mass(1, 1) * rate * rate;
  for (const auto& [budget, slower] : {std::pair{2.0 * cost, 1.0}, {0.25 * cost, 0.5}, {0.0, 0.25}}) {
    scene.step.s[0] = {0, 0, 0, float(budget)};
    sort_near_ground(scene.spheres, scene.dense, scene.ground, scene.constants, 0.05f, Simd::portable, 0, 1,
                     scene.step);
    ASSERT_EQ(scene.state(), GroundState::lies);
    lie_on_ground(scene.spheres, scene.dense, scene.ground, scene.constants, Simd::portable, 0, 1,
                  scene.step);
    const Vec3 omega = scene.cube->inverse_inertia_per_mass * scene.spin();
    EXPECT_LT((omega - Vec3(0, -slower * rate, 0)).norm(), 1e-4 * rate) << budget;
    scene.step.s[0] = {};
    scene.step.on_ground[0] = std::uint8_t(GroundState::near);
  }
}

// On a slope a body at rest on a face slides by g (sin β − μ cos β), or not at all.
TEST(SphereGround, OnASlopeItSlidesOrHolds) {
  for (const double friction : {0.2, 0.7}) {
    const double slope = 0.5;
    const HalfSpace plane{{std::sin(slope), 0, std::cos(slope)}, 0.0};
    OnPlane scene(at({0, 0, 0}), plane, friction);
    scene.spheres.motion[0] = Motion::settling;
    scene.lie(true, float(kGravity * std::cos(slope) * kStep));
    const double along = scene.velocity().dot(Vec3(std::cos(slope), 0, -std::sin(slope)));
    const double expected = std::max(0.0, std::sin(slope) - friction * std::cos(slope)) * kGravity * kStep;
    EXPECT_NEAR(along, expected, 1e-6) << friction;
    EXPECT_NEAR(scene.velocity().dot(plane.normal), 0.0, 1e-6);
  }
}

TEST(SphereGround, ARoundEndsTheApproachAndNeverPulls) {
  for (const double up : {-0.5, 0.5}) {
    OnPlane scene(at({0, 0, 0}));
    scene.start();
    scene.step.on_ground[0] = std::uint8_t(GroundState::lies);
    scene.step.plane[0] = 0, scene.step.gap[0] = 0.0f;
    scene.step.p[0] = {1.0f, 0.0f, float(up), 1.0f};
    for (int round = 0; round < 2; ++round) {
      sweep_ground(scene.ground, scene.constants, Simd::portable, 0, 1, scene.step);
      take_impulses(Simd::portable, 0, 1, scene.step);
    }
    EXPECT_NEAR(scene.velocity().z(), std::max(0.0, up), 1e-6);
    EXPECT_NEAR(scene.step.a[0].w, std::max(0.0, -up), 1e-6);
    // Drawn away later, it gives back what it gave, and no more.
    scene.step.p[0].z = 2.0f;
    sweep_ground(scene.ground, scene.constants, Simd::portable, 0, 1, scene.step);
    EXPECT_EQ(scene.step.a[0].w, 0.0f);
    EXPECT_NEAR(scene.velocity().z(), 2.0 - std::max(0.0, -up), 1e-6);
  }
}

// What contacts push into the ground in a round stops there in the same one, of spheres that know their
// hulls; the paper's are answered by what they were before.
TEST(SphereGround, TheLastRoundLeavesNothingThatMovesIntoTheGround) {
  for (const bool hulls : {true, false}) {
    OnPlane scene(at({0, 0, 0}));
    scene.constants.hulls = hulls;
    scene.start();
    scene.step.on_ground[0] = std::uint8_t(GroundState::lies);
    scene.step.plane[0] = 0, scene.step.gap[0] = 0.0f;
    scene.step.p[0] = {1.0f, 0.0f, -0.25f, 1.0f};
    scene.step.a[0] = {0.0f, 0.0f, -0.5f, 0.0f};  // from a contact
    sweep_ground(scene.ground, scene.constants, Simd::portable, 0, 1, scene.step);
    EXPECT_NEAR(scene.velocity().z(), hulls ? 0.0 : -0.5, 1e-6);
    EXPECT_NEAR(scene.step.a[0].w, hulls ? 0.75 : 0.25, 1e-6);
  }
}

// Alone it goes down onto the plane at once, and out of it by a quarter of the way.
TEST(SphereGround, GapsCloseAndOverlapsOpenGradually) {
  for (const auto& [gap, raise] : {std::pair{2e-4, -2e-4}, {-0.02, 0.005}}) {
    OnPlane scene(at({0, 0, 0}), {}, kFriction, gap);
    scene.spheres.motion[0] = Motion::settling;
    scene.lie(false);
    ASSERT_EQ(scene.state(), GroundState::lies) << gap;
    EXPECT_NEAR(scene.step.push_out(0).z(), raise, 1e-6);
  }
}

// What others would move into the plane stays over it; who touches nobody is moved by none.
TEST(SphereGround, ContactsMoveNobodyIntoIt) {
  for (const double gap : {0.0, 0.004}) {
    OnPlane scene(at({0, 0, 0}, {0, 0, -1}), {}, kFriction, gap);
    scene.lie(true);
    const auto moved = [&](float z) {
      scene.step.d[0] = {0.01f, 0.0f, z, 0.0f};
      keep_on_ground(scene.ground, 0, 1, scene.step);
      return scene.step.push_out(0);
    };
    EXPECT_LT((moved(-0.02f) - Vec3(0.01, 0, -gap)).norm(), 1e-6) << gap;
    EXPECT_LT((moved(0.02f) - Vec3(0.01, 0, 0.02)).norm(), 1e-6) << gap;
    scene.step.p[0].w = 0.0f;
    EXPECT_LT((moved(-0.02f) - Vec3(0.01, 0, -0.02)).norm(), 1e-6) << gap;
  }
}

TEST(SphereGround, IsTheSameToTheBitOnEveryProcessor) {
  std::vector<double> expected;
  for (const Simd simd : testing::kEverySimd) {
    if (!testing::has(simd)) continue;
    OnPlane scene(at({0, 0, 0}));
    RandomStream random(9, 0, 0);
    for (int i = 0; i < 70; ++i) {
      scene.add(scene.cube, 1.0,
                at({random.uniform(-2, 2), 0, random.uniform(0.16, 0.2)}, 0.1 * random.direction(),
                   random.direction(), random.orientation()));
      scene.spheres.motion[std::size_t(i)] = i % 2 ? Motion::settling : Motion::dynamic;
      scene.spheres.held[std::size_t(i)] = 0.1f;
    }
    const std::int64_t all = scene.spheres.awake;
    scene.start(simd);
    find_near_ground(scene.spheres, scene.dense, scene.ground, scene.plane, 0, scene.constants, simd, 0, all,
                     scene.step);
    for (std::int64_t i = 0; i < all; i += 3) scene.step.p[std::size_t(i)].w = 1.0f;
    sort_near_ground(scene.spheres, scene.dense, scene.ground, scene.constants, 0.05f, simd, 0, all,
                     scene.step);
    sweep_ground(scene.ground, scene.constants, simd, 0, all, scene.step);
    lie_on_ground(scene.spheres, scene.dense, scene.ground, scene.constants, simd, 0, all, scene.step);
    scene.end(simd);
    const std::vector<double> found = scene.numbers();
    if (expected.empty()) expected = found;
    EXPECT_TRUE(found == expected) << int(simd);
  }
}

}  // namespace
}  // namespace lodestone::sphere_ground_test
