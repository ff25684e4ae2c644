#include "lod/tables/sphere_motion.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/lod/tables/sphere_fixture.h"

namespace lodestone::sphere_motion_test {
namespace {

using testing::at;
using testing::box_shape;
using testing::kGravity;
using testing::SphereScene;

// To the bit of double precision, however far from the origin: x + v t + ½ g t².
TEST(SphereMotion, FreeFlightIsAParabola) {
  for (const double away : {0.0, 1e5}) {
    SphereScene scene(1.0 / 60.0);
    scene.add(box_shape({0.2, 0.3, 0.4}), 2.0, at({away, 2, 30}, {3, -1, 5}, {1, 2, 3}));
    const Vec3 spin = scene.spheres.spin(0);
    for (int i = 0; i < 60; ++i) scene.start(), scene.end();
    EXPECT_LT((scene.spheres.position(0) - Vec3(away + 3, 1, 35 - kGravity / 2)).norm(), 1e-9);
    EXPECT_LT((scene.spheres.velocity(0) - Vec3(3, -1, 5 - kGravity)).norm(), 1e-12);
    EXPECT_EQ(scene.spheres.spin(0), spin);
    EXPECT_EQ(scene.step.on_ground[0], std::uint8_t(GroundState::free));
    EXPECT_NEAR(scene.spheres.orientation(0).norm(), 1.0, 1e-6);
  }
}

TEST(SphereMotion, TurnsByItsAngularVelocity) {
  SphereScene scene(0.01, Vec3::Zero());
  scene.add(box_shape({0.2, 0.3, 0.4}), 2.0, at({0, 0, 0}, {0, 0, 0}, {0, 0, 2.5}));
  for (int i = 0; i < 100; ++i) scene.start(), scene.end();
  EXPECT_LT(scene.spheres.orientation(0).angularDistance(rotation_from_vector(Vec3(0, 0, 2.5))), 1e-5);
}

// Linear in α = atan(Rω/v) between .5 R at 0 and R at π/2: at Rω = v the mean of both.
TEST(SphereMotion, TheRadiusOfAFlyingSphereFollowsItsTable) {
  const auto box = box_shape({0.2, 0.2, 0.2});
  const double size = box->radius;
  for (const auto& [spin, height] : {std::pair{0.0, 0.5}, {1.0, 0.75}, {std::sqrt(3.0), 5.0 / 6.0}}) {
    SphereScene scene;
    scene.add(box, 1.0, at({0, 0, 9}, {0, 2, 0}, {spin * 2 / size, 0, 0}), {0.5f, 1.0f});
    scene.start();
    EXPECT_NEAR(scene.spheres.radius[0], height * size, 2e-6) << spin;
  }
  SphereScene off;
  off.constants.update_radius = false;
  off.add(box, 1.0, at({0, 0, 9}, {0, 2, 0}), {0.5f, 1.0f});
  off.start();
  EXPECT_EQ(off.spheres.radius[0], float(size));
}

TEST(SphereMotion, ASphereGrowsNoFasterThanItsBodyMoves) {
  const auto box = box_shape({0.2, 0.2, 0.2});
  SphereScene scene;
  scene.add(box, 1.0, at({0, 0, 9}, {0.3, 0, 0}, {0, 0, 1}), {1.0f, 1.0f});
  scene.spheres.radius[0] = 0.05f;
  scene.start();
  EXPECT_NEAR(scene.spheres.radius[0], 0.05 + (0.3 + box->radius) / 60.0, 1e-7);
  scene.spheres.since_crowded[0] = 0;  // among others it keeps its radius
  scene.spheres.radius[0] = 0.05f;
  scene.start();
  EXPECT_EQ(scene.spheres.radius[0], 0.05f);
}

TEST(SphereMotion, ReachCoversTheWayOfTheStep) {
  const auto box = box_shape({0.2, 0.2, 0.2});
  SphereScene scene(0.1);
  scene.add(box, 1.0, at({0, 0, 9}, {-3, 0, -4}));
  scene.start();
  const double way = 5 * 0.1 + 0.5 * kGravity * 0.01;
  EXPECT_GT(scene.step.reach[0], scene.spheres.radius[0] + way);
  EXPECT_NEAR(scene.step.reach[0], scene.spheres.radius[0] + way + 0.01 * box->radius, 1e-6);
}

TEST(SphereMotion, TheStartTellsVelocityEnergyAndSoftness) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  SphereScene scene(0.1);
  const RigidState state = at({0, 0, 9}, {1, 2, 3}, {4, 5, 6});
  scene.add(box, 2.0, state);
  scene.start();
  EXPECT_NEAR(scene.step.p[0].z, 3 - 0.981, 1e-6);
  EXPECT_EQ(scene.step.p[0].w, 0.0f);
  EXPECT_NEAR(scene.step.s[0].w, kinetic_energy(*box, state), 1e-4);
  EXPECT_NEAR(scene.step.u[0].y, scene.spheres.radius[0] * 5, 1e-5);
  // 1 + r² / I with the least moment, about the longest axis: (.2² + .3²)/12.
  EXPECT_NEAR(scene.step.u[0].w, 1 + std::pow(scene.spheres.radius[0], 2) * 12 / 0.13, 1e-4);
}

// What contacts give counts in the same step: the body goes where its solved velocity takes it, not along the
// parabola.
TEST(SphereMotion, ATouchedBodyGoesWithWhatItsContactsGave) {
  SphereScene scene(0.1);
  scene.add(box_shape({0.2, 0.2, 0.2}), 1.0, at({0, 0, 9}, {1, 0, 0}));
  scene.start();
  scene.step.p[0].w = 1.0f;  // one contact
  scene.step.a[0] = {0.0f, 2.0f, 0.981f, 0.0f};
  scene.step.d[0] = {0.0f, 0.0f, 0.03f, 0.0f};
  scene.end();
  EXPECT_LT((scene.spheres.velocity(0) - Vec3(1, 2, 0)).norm(), 1e-6);
  EXPECT_LT((scene.spheres.position(0) - Vec3(0.1, 0.2, 9.03)).norm(), 1e-6);
  EXPECT_EQ(scene.spheres.since_crowded[0], 0);
  EXPECT_EQ(scene.spheres.crowded_for[0], scene.constants.ticks);
  for (int i = 0; i < 20; ++i) scene.start(), scene.end();
  EXPECT_EQ(scene.spheres.since_crowded[0], 255);  // as far as it counts
  EXPECT_EQ(scene.spheres.crowded_for[0], 0);
}

// A hull among others turns on its edges: its weight takes g t times the lever off
// its spin in each step, along the spin, until there is none. What touches it without pressing takes nothing.
TEST(SphereMotion, AHullAmongOthersResistsRolling) {
  const auto box = box_shape({0.2, 0.2, 0.2});
  const Vec3 spin(3, 0, 4), axis = spin.normalized();
  const double loss = std::sqrt(axis.dot(find_rolling_levers(*box) * axis)) * kGravity / 60.0;
  for (const bool hulls : {true, false})
    for (const double pressed : {0.0, 0.05, 1.0, 3.0}) {  // times its weight
      SphereScene scene;
      scene.constants.hulls = hulls;
      scene.add(box, 1.0, at({0, 0, 9}, {0, 0, 0}, spin));
      const Vec3 before = scene.spheres.spin(0);
      const auto step = [&] {
        scene.start();
        scene.step.p[0].w = 1.0f;
        scene.step.p[0].z += float(pressed * kGravity / 60.0);
        scene.end();
      };
      step();
      const double share = pressed > 0.0 ? 1.0 : 0.0,
                   expected = hulls ? 1.0 - share * loss / before.norm() : 1.0;
      EXPECT_LT((scene.spheres.spin(0) - expected * before).norm(), 1e-6 * before.norm());
      if (!hulls || pressed == 0.0) continue;
      for (int i = 0; i < int(before.norm() / loss); ++i) step();
      EXPECT_EQ(scene.spheres.spin(0), Vec3(Vec3::Zero()));
    }
}

TEST(SphereMotion, BodiesAlreadyMovedAreLeftAlone) {
  SphereScene scene;
  scene.add(box_shape({0.2, 0.3, 0.4}), 1.0, at({1, 2, 3}, {4, 5, 6}, {7, 8, 9}));
  const Vec3 spin = scene.spheres.spin(0);
  scene.start();
  scene.step.on_ground[0] = std::uint8_t(GroundState::moved);
  scene.end();
  EXPECT_EQ(scene.spheres.position(0), Vec3(1, 2, 3));
  EXPECT_EQ(scene.spheres.velocity(0), Vec3(4, 5, 6));
  EXPECT_EQ(scene.spheres.spin(0), spin);
  EXPECT_EQ(scene.spheres.qw[0], 1.0f);
}

TEST(SphereMotion, StatesThatCannotBeAreMarked) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const RigidState& state :
       {at({0, 0, 1}, {nan, 0, 0}), at({0, infinity, 0}), at({0, 0, 1}, {0, 0, 2e6}), at({2e8, 0, 0}),
        at({0, 0, 1}, {0, 0, 0}, {0, nan, 0}), at({0, 0, 1}, {0, 0, 0}, {0, 0, 0}, Quat(0.5, 0, 0, 0))}) {
    SphereScene scene;
    scene.add(box_shape({0.2, 0.2, 0.2}), 1.0, state);
    scene.start(), scene.end();
    EXPECT_EQ(scene.step.on_ground[0], std::uint8_t(GroundState::unsound)) << state.position.transpose();
  }
}

TEST(SphereMotion, IsTheSameToTheBitOnEveryProcessor) {
  for (const bool one_kind : {true, false}) {
    std::vector<double> expected;
    for (const Simd simd : testing::kEverySimd) {
      if (!testing::has(simd)) continue;
      SphereScene scene;
      scene.constants.one_kind = one_kind;
      RandomStream random(7, 0, 0);
      for (int i = 0; i < 83; ++i) {  // no multiple of any width
        RigidState state = at(3 * random.direction(), random.uniform(0, 5) * random.direction(),
                              random.uniform(0, 20) * random.direction(), random.orientation());
        scene.add(box_shape({0.2, 0.3, !one_kind && i % 3 == 0 ? 0.5 : 0.4}), 1.0, state, {0.5f, 0.8f, 0.7f});
        scene.spheres.since_crowded[std::size_t(i)] = std::uint8_t(i % 2 * 200);
        scene.spheres.motion[std::size_t(i)] = i % 5 == 0 ? Motion::settling : Motion::dynamic;
      }
      for (int i = 0; i < 3; ++i) {
        scene.start(simd);
        for (std::size_t k = 0; k < 83; k += 4)
          scene.step.p[k].w = 1.0f, scene.step.a[k] = {0.1f, 0.2f, 0.3f, 0.0f}, scene.step.s[k].x = 0.01f;
        take_impulses(simd, 0, 83, scene.step);
        scene.end(simd);
      }
      const std::vector<double> found = scene.numbers();
      if (expected.empty()) expected = found;
      EXPECT_TRUE(found == expected) << int(simd);
    }
  }
}

TEST(SphereMotion, TakenImpulsesMoveIntoTheVelocity) {
  SphereScene scene(0.1, Vec3::Zero());
  scene.add(box_shape({0.2, 0.2, 0.2}), 1.0, at({0, 0, 0}, {1, 0, 0}));
  scene.start();
  scene.step.p[0].w = 2.0f;
  scene.step.a[0] = {0.5f, 0.25f, 0.0f, 3.0f};  // the fourth is what the ground gives
  take_impulses(Simd::portable, 0, 1, scene.step);
  EXPECT_EQ(scene.step.p[0].x, 1.5f);
  EXPECT_EQ(scene.step.p[0].y, 0.25f);
  EXPECT_EQ(scene.step.p[0].w, 2.0f);
  EXPECT_EQ(scene.step.a[0].x, 0.0f);
  EXPECT_EQ(scene.step.a[0].w, 3.0f);
}

}  // namespace
}  // namespace lodestone::sphere_motion_test
