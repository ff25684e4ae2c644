// What a step says of touches, against what the bodies say by their velocities.
#include "reference/ode/touches_ode.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// Whatever hits the ground: the sum of impulses along the normals is the change of its momentum, less what
// gravity gave.
TEST(TouchesOfOde, ImpulsesAddUpToTheMomentum) {
  RandomStream random(6, 0, 0);
  for (int i = 0; i < 10; ++i) {
    const MaterialTable materials = material(random.uniform(0, 0.8), 0.0);
    OdeWorld world({}, materials);
    const OdeGroundId floor = world.add_plane(Vec3::UnitZ(), 0.0, 0);
    world.record_touches(true);
    const double mass = random.uniform(1, 10);
    const OdeBodyId body =
        world.add_body({.shape = box_shape({0.2, 0.3, 0.4}),
                        .mass = mass,
                        .state = at({0, 0, 0.35}, {0, 0, -2}, random.direction(), random.orientation())});
    double given = 0.0, before = mass * world.state(body).velocity.z();
    for (int step = 0; step < 30; ++step) {
      world.step(1.0 / 60, 4);
      for (const OdeTouch& touch : world.touches()) {
        EXPECT_EQ(touch.first, body);
        EXPECT_EQ(touch.ground, floor);
        EXPECT_FALSE(touch.second);
        EXPECT_GE(touch.impulse, 0.0);
        EXPECT_GE(touch.approach, 0.0);
        given += touch.impulse;
      }
    }
    const double after = mass * world.state(body).velocity.z();
    EXPECT_NEAR(given, after - before + mass * kGravity * 0.5, 1e-6 * mass) << i;
  }
}

// Events of such contacts were told of at the origin.
TEST(TouchesOfOde, NothingIsToldOfASubstepThatIsTakenBack) {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  const dJointGroupID joints = dJointGroupCreate(0);
  dContact contact{};
  contact.geom.normal[2] = 1.0;
  ode::Touches touches;
  const auto watch = [&] {
    const dJointID joint = dJointCreateContact(world, joints, &contact);
    dJointAttach(joint, body, nullptr);
    touches.watch(joint, {.body = body, .id = {1}}, {.ground = {1}}, {.point = {1, 2, 3}}, 0.5);
  };
  touches.begin_step();
  touches.begin_substep();
  watch();
  touches.begin_substep();  // again
  touches.end_substep(0.01);
  EXPECT_TRUE(touches.all().empty());
  touches.begin_substep();
  watch();
  touches.end_substep(0.01);
  ASSERT_EQ(touches.all().size(), 1u);
  EXPECT_EQ(touches.all()[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(touches.all()[0].approach, 0.5);
  dJointGroupDestroy(joints);
  dWorldDestroy(world);
}

// Of a head-on hit: one touch, both by name, the speed at which they met and (1 + e) of the momentum.
TEST(TouchesOfOde, AHitHasItsSpeedAndImpulse) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const MaterialTable materials = material(e, 0.0);
    OdeWorld world({.gravity = Vec3::Zero()}, materials);
    world.record_touches(true);
    const auto ball = sphere_shape(0.2);
    const OdeBodyId a = world.add_body({.shape = ball, .mass = 2.0, .state = at({-0.3, 0, 0}, {1.5, 0, 0})}),
                    b = world.add_body({.shape = ball, .mass = 3.0, .state = at({0.3, 0, 0}, {-1.5, 0, 0})});
    double impulse = 0.0, approach = 0.0;
    for (int i = 0; i < 60; ++i) {
      world.step(1.0 / 240);
      for (const OdeTouch& touch : world.touches()) {
        EXPECT_TRUE((touch.first == a && touch.second == b) || (touch.first == b && touch.second == a));
        EXPECT_NEAR(std::abs(touch.normal.x()), 1.0, 1e-9);
        EXPECT_NEAR(touch.point.x(), 0.0, 0.05);
        impulse += touch.impulse, approach = std::max(approach, touch.approach);
      }
    }
    EXPECT_NEAR(approach, 3.0, 1e-6);
    const double expected = (1 + e) * 3.0 * 6.0 / 5.0;
    EXPECT_GE(impulse, expected - 1e-6);
    EXPECT_LE(impulse, 1.25 * expected);  // what is left of an overlap is pushed apart besides
  }
}

TEST(TouchesOfOde, NoneUnlessTheyAreRecordedAndNoneInFlight) {
  const MaterialTable materials;
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  world.add_body({.shape = box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 0.1})});
  world.step(1.0 / 60);
  EXPECT_TRUE(world.touches().empty());
  world.record_touches(true);
  world.step(1.0 / 60);
  EXPECT_EQ(world.touches().size(), 1U);
  world.record_touches(false);
  world.step(1.0 / 60);
  EXPECT_TRUE(world.touches().empty());
}

// Resting on it, a weight is what the floor bears: m g t, whichever substeps.
TEST(TouchesOfOde, AWeightIsBorne) {
  for (const int substeps : {1, 4, 10}) {
    const MaterialTable materials = material(0.0, 0.5);
    OdeWorld world({}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    world.record_touches(true);
    world.add_body({.shape = box_shape({0.4, 0.4, 0.4}), .mass = 7.0, .state = at({0, 0, 0.2})});
    double borne = 0.0;
    for (int i = 0; i < 60; ++i) {
      world.step(1.0 / 60, substeps);
      if (i < 30) continue;
      ASSERT_EQ(world.touches().size(), 1U);
      borne += world.touches()[0].impulse;
      EXPECT_TRUE(world.touches()[0].at_end);
    }
    EXPECT_NEAR(borne, 7.0 * kGravity * 0.5, 0.01 * 7.0 * kGravity * 0.5) << substeps;
  }
}

}  // namespace
}  // namespace lodestone
