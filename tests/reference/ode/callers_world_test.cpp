// At home in somebody's world: his spaces, his forces, his loop, his moving ground.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <functional>
#include <stdexcept>

#include "reference/error.h"
#include "tests/reference/ode/ode_fixture.h"
#include "tests/reference/ode/space_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kFrame = 1.0 / 60;

struct His {
  explicit His(SpaceType type = SpaceType::hash) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    space = make_space(type);
    dWorldSetGravity(world, 0, 0, -kGravity);
  }
  ~His() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  His(const His&) = delete;
  His& operator=(const His&) = delete;

  dGeomID box(const Vec3& sides, const Vec3& position, dSpaceID in = nullptr) const {
    const dGeomID geom = dCreateBox(in ? in : space, sides.x(), sides.y(), sides.z());
    dGeomSetPosition(geom, position.x(), position.y(), position.z());
    return geom;
  }
  // Of 2 m sides. ODE keeps what it is given.
  void convex_cube(const Vec3& position) const {
    static const dReal planes[] = {1, 0, 0, 1, -1, 0, 0, 1, 0, 1, 0, 1, 0, -1, 0, 1, 0, 0, 1, 1, 0, 0, -1, 1};
    static const dReal corners[] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1,
                                    -1, -1, 1,  1, -1, 1,  -1, 1, 1,  1, 1, 1};
    static const unsigned faces[] = {4, 1, 3, 7, 5, 4, 0, 4, 6, 2, 4, 2, 6, 7, 3,
                                     4, 0, 1, 5, 4, 4, 4, 5, 7, 6, 4, 0, 2, 3, 1};
    dGeomSetPosition(dCreateConvex(space, planes, 6, corners, 8, faces), position.x(), position.y(),
                     position.z());
  }
  dBodyID body(double mass, const Vec3& position) const {
    const dBodyID made = dBodyCreate(world);
    dMass parameters;
    dMassSetBoxTotal(&parameters, mass, 0.2, 0.2, 0.2);
    dBodySetMass(made, &parameters);
    dBodySetPosition(made, position.x(), position.y(), position.z());
    return made;
  }
  // Of `sides`, kinematic, its top at z = 0.
  dBodyID platform(const Vec3& sides) const {
    const dBodyID made = body(1.0, {0, 0, -sides.z() / 2});
    dGeomSetBody(box(sides, Vec3::Zero()), made);
    dBodySetKinematic(made);
    return made;
  }

  dWorldID world;
  dSpaceID space;
};

const MaterialTable kMaterials = material(0.0, 0.5);
const OdeSettings kSleeping{.auto_disable = true};

OdeBodyId add_crate(OdeWorld& world, const Vec3& position, const BodyProperties& properties = {}) {
  static const auto shape = box_shape({0.4, 0.4, 0.4});
  return world.add_body({.shape = shape, .mass = 64.0, .state = at(position), .properties = properties});
}

void step(OdeWorld& world, int steps, int substeps = 4) {
  for (int i = 0; i < steps; ++i) world.step(kFrame, substeps);
}

class SpaceOfHis : public ::testing::TestWithParam<SpaceType> {};

TEST_P(SpaceOfHis, OurBodiesRestOnWhatItHolds) {
  His his(GetParam());
  for (int i = 0; i < 40; ++i) his.box({1, 1, 1}, {i - 20.0, 0, -0.5});
  const dSpaceID inner = make_space(SpaceType::quadtree, make_space(SpaceType::simple, his.space));
  his.box({1, 1, 1}, {0, 5, 0.5}, inner);
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  const OdeBodyId on_boxes = add_crate(ours, {0.3, 0, 0.3}), on_nested = add_crate(ours, {0, 5, 1.3});
  step(ours, 120);
  EXPECT_NEAR(ours.state(on_boxes).position.z(), 0.2, 1e-3);
  EXPECT_NEAR(ours.state(on_nested).position.z(), 1.2, 1e-3);
  EXPECT_TRUE(ours.asleep(on_boxes) && ours.asleep(on_nested));
}

TEST_P(SpaceOfHis, WhatCameWentAndMovedWakesWhatLayThere) {
  His his(GetParam());
  std::vector<dGeomID> pads;
  for (int i = 0; i < 4; ++i) pads.push_back(his.box({1, 1, 1}, {3.0 * i, 0, -0.5}));
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  std::vector<OdeBodyId> crates;
  for (int i = 0; i < 4; ++i) crates.push_back(add_crate(ours, {3.0 * i, 0, 0.2}));
  step(ours, 60);
  for (const OdeBodyId crate : crates) ASSERT_TRUE(ours.asleep(crate));

  dGeomDestroy(pads[0]);                     // goes
  dGeomSetPosition(pads[1], 3, 0, -0.6);     // sinks by a tenth of a metre
  his.box({0.2, 0.2, 0.2}, {6.25, 0, 0.1});  // comes, a little into the third crate
  step(ours, 30);
  EXPECT_LT(ours.state(crates[0]).position.z(), -0.5);
  EXPECT_NEAR(ours.state(crates[1]).position.z(), 0.1, 1e-3);
  EXPECT_LT(ours.state(crates[2]).position.x(), 6.0 - 0.03);
  EXPECT_TRUE(ours.asleep(crates[3]));
}

INSTANTIATE_TEST_SUITE_P(EveryType, SpaceOfHis,
                         ::testing::Values(SpaceType::simple, SpaceType::hash, SpaceType::sweep,
                                           SpaceType::quadtree));

TEST(CallersOdeWorld, OursAreNotInHisSpace) {
  His his;
  OdeWorld ours(his.world, his.space, {}, kMaterials);
  add_crate(ours, {0, 0, 1});
  EXPECT_EQ(dSpaceGetNumGeoms(his.space), 0);
}

TEST(CallersOdeWorld, HisConvexCapsuleAndHeightFieldHoldOurs) {
  His his;
  for (const double x : {0.0, 20.0}) his.convex_cube({x, 0, -1});
  const dHeightfieldDataID heights = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(
      heights, nullptr, [](void*, int, int) { return dReal(0); }, 6, 6, 7, 7, 1, 0, 1, 0);
  const dGeomID field = dCreateHeightfield(his.space, heights, 1);
  const dQuaternion upright = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(field, upright);
  dGeomSetPosition(field, 10, 0, 0);
  {
    OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
    const OdeBodyId on_convex = add_crate(ours, {0.2, 0.1, 0.25}),
                    on_field = add_crate(ours, {10.2, 0.1, 0.25});
    const auto bunny =
        std::make_shared<const Shape>(make_bunny_shape(0.3, 194));  // a mesh that is met as it is
    const OdeBodyId bunny_on_convex = ours.add_body({.shape = bunny, .mass = 5.0, .state = at({20, 0, 0.3})});
    step(ours, 180);
    EXPECT_NEAR(ours.state(on_convex).position.z(), 0.2, 2e-3);
    EXPECT_NEAR(ours.state(on_field).position.z(), 0.2, 2e-3);
    EXPECT_GT(ours.state(bunny_on_convex).position.z(), 0.05);
  }
  dGeomHeightfieldDataDestroy(heights);
}

// Which mesh knows the angles between its faces was remembered by an address, which the next one of many may
// have: ODE ended the process.
TEST(CallersOdeWorld, HisConvexHoldsMoreMeshesThanAreKept) {
  His his;
  his.convex_cube({0, 0, -1});
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  const Shape bunny = make_bunny_shape(0.3, 194);
  for (int i = 0; i < 140; ++i) {
    const auto shape = std::make_shared<const Shape>(scale_shape(bunny, 1.0 + 1e-3 * i));
    const OdeBodyId body = ours.add_body({.shape = shape, .mass = 5.0, .state = at({0, 0, 0.15})});
    step(ours, 4);
    EXPECT_GT(ours.state(body).position.z(), 0.05) << i;
    ours.remove_body(body);
  }
}

// What a step of `substeps` makes of a force, and of a motor, that act for one frame.
TEST(CallersOdeWorld, HisForcesActForTheWholeStep) {
  for (const int substeps : {1, 4}) {
    His his;
    dWorldSetGravity(his.world, 0, 0, 0);
    const dBodyID ball = his.body(2.0, {0, 0, 5}), arm = his.body(2.0, {3, 0, 5}),
                  alone = his.body(2.0, {6, 0, 5}), named = his.body(2.0, {9, 0, 5});
    dGeomSetBody(dCreateSphere(his.space, 0.1), ball);
    const dJointID hinge = dJointCreateHinge(his.world, nullptr);
    dJointAttach(hinge, arm, ball);
    dJointSetHingeAnchor(hinge, 0, 0, 5), dJointSetHingeAxis(hinge, 0, 0, 1);
    OdeWorld ours(his.world, his.space, {}, kMaterials);
    const OdeBodyId crate = add_crate(ours, {0, 20, 5});
    ours.include_body(named);
    dBodyAddForce(ball, 0, 0, 12), dBodyAddForce(arm, 0, 0, 12);
    dBodyAddForce(named, 12, 0, 0), dBodyAddTorque(ours.ode_body(crate), 0, 0, 3);
    dBodyAddForce(ours.ode_body(crate), 64, 0, 0);
    ours.step(kFrame, substeps);
    EXPECT_NEAR(dBodyGetLinearVel(ball)[2], 6 * kFrame, 1e-9);
    EXPECT_NEAR(dBodyGetLinearVel(arm)[2], 6 * kFrame, 1e-9) << "on a body without geoms, on a joint";
    EXPECT_NEAR(dBodyGetLinearVel(named)[0], 6 * kFrame, 1e-12);
    EXPECT_EQ(dBodyGetLinearVel(alone)[2], 0.0);
    EXPECT_NEAR(ours.state(crate).velocity.x(), kFrame, 1e-12);
    EXPECT_NEAR(ours.state(crate).angular_velocity.z(), 3 * kFrame / (64 * 0.16 / 6), 1e-9);
    for (const dBodyID body : {ball, arm, named})
      EXPECT_EQ(dBodyGetForce(body)[0] + dBodyGetForce(body)[2], 0.0);
    ours.step(kFrame, substeps);
    EXPECT_NEAR(dBodyGetLinearVel(named)[0], 6 * kFrame, 1e-12) << "and for that step alone";
  }
}

TEST(CallersOdeWorld, AMotorTurnsAsFastInSubsteps) {
  double speed[2];
  for (const int i : {0, 1}) {
    His his;
    const dBodyID wheel = his.body(3.0, {0, 0, 5});
    dGeomSetBody(dCreateSphere(his.space, 0.2), wheel);
    const dJointID hinge = dJointCreateHinge(his.world, nullptr);
    dJointAttach(hinge, wheel, nullptr);
    dJointSetHingeAnchor(hinge, 0, 0, 5), dJointSetHingeAxis(hinge, 0, 0, 1);
    OdeWorld ours(his.world, his.space, {}, kMaterials);
    for (int frame = 0; frame < 30; ++frame) {
      dJointAddHingeTorque(hinge, 0.05);
      ours.step(kFrame, i == 0 ? 1 : 4);
    }
    speed[i] = dBodyGetAngularVel(wheel)[2];
  }
  EXPECT_GT(speed[0], 0.5);
  EXPECT_NEAR(speed[1] / speed[0], 1.0, 1e-6);
}

// His own dWorldStep between the two calls gives what step() gives, to the bit.
TEST(CallersOdeWorld, HisOwnLoopComesToTheSame) {
  RigidState states[2];
  double heights[2];
  for (const int i : {0, 1}) {
    His his;
    dCreatePlane(his.space, 0, 0, 1, 0);
    his.box({0.5, 0.5, 0.5}, {0.2, 0, 0.25});
    const dBodyID ball = his.body(2.0, {0.1, 0.1, 1.8});
    dGeomSetBody(dCreateSphere(his.space, 0.1), ball);
    OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
    const OdeBodyId crate = add_crate(ours, {0, 0, 1.2});
    for (int frame = 0; frame < 200; ++frame) {
      if (frame == 50) ours.add_force(crate, {3000, 0, 0}, Vec3::Zero());
      if (i == 0) {
        ours.step(kFrame, 1);
      } else {
        ours.begin_callers_step(kFrame);
        EXPECT_THROW(ours.step(kFrame), InputError);
        dWorldStep(his.world, kFrame);
        ours.end_callers_step();
      }
    }
    EXPECT_THROW(ours.end_callers_step(), InputError);
    states[i] = ours.state(crate);
    heights[i] = dBodyGetPosition(ball)[2];
  }
  EXPECT_TRUE(same_bits(states[0], states[1]));
  EXPECT_EQ(heights[0], heights[1]);
}

/// How far a crate on a platform, and one on top of it, went while that went half a metre.
std::pair<double, double> carried_by(double speed, int substeps) {
  His his;
  const dBodyID platform = his.platform({4, 4, 0.2});
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  const OdeBodyId crate = add_crate(ours, {0, 0, 0.2}), upper = add_crate(ours, {0, 0, 0.6});
  step(ours, 60, substeps);
  EXPECT_TRUE(ours.asleep(crate) && ours.asleep(upper));
  dBodySetLinearVel(platform, speed, 0, 0);
  step(ours, int(std::lround(0.5 / speed * 60)), substeps);
  EXPECT_NEAR(dBodyGetPosition(platform)[0], 0.5, 1e-9);
  EXPECT_FALSE(ours.asleep(crate) || ours.asleep(upper));
  return {ours.state(crate).position.x(), ours.state(upper).position.x()};
}

TEST(CallersOdeWorld, AMovingPlatformCarriesSleepers) {
  for (const double speed : {0.03, 0.25, 0.5})
    for (const int substeps : {1, 4, 8}) {
      const auto [lower, upper] = carried_by(speed, substeps);
      const double slip = speed * speed / (2 * 0.5 * kGravity) +
                          0.5 * speed * kFrame;  // until friction has brought it to speed
      EXPECT_NEAR(lower, 0.5, slip + 5e-3) << speed << " m/s, " << substeps;
      EXPECT_NEAR(upper, 0.5, 2 * slip + 5e-3) << speed << " m/s, " << substeps;
    }
}

TEST(CallersOdeWorld, ATurningTableAndALiftCarry) {
  His his;
  const dBodyID table = his.platform({4, 4, 0.2});
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  const OdeBodyId crate = add_crate(ours, {0.5, 0.2, 0.2});
  step(ours, 60);
  dBodySetAngularVel(table, 0, 0, 0.5);
  dBodySetLinearVel(table, 0, 0, 0.3);
  step(ours, 60);
  const double angle = 0.5;
  const Vec3 expected(0.5 * std::cos(angle) - 0.2 * std::sin(angle),
                      0.5 * std::sin(angle) + 0.2 * std::cos(angle), 0.5);
  EXPECT_LT((ours.state(crate).position - expected).norm(), 0.02);
  dBodySetAngularVel(table, 0, 0, 0), dBodySetLinearVel(table, 0, 0, 0);
  step(ours, 60);
  EXPECT_TRUE(ours.asleep(crate));  // once it stands
}

// Without a velocity it pushes by its overlap alone, which is undone at 1 m/s at most, but for what goes on
// and on: faster ones went through.
TEST(CallersOdeWorld, WhatHePutsOnAndOnLiftsAsFastAsItGoes) {
  OdeSettings careful = kSleeping;
  careful.max_correcting_velocity = 1.0;
  for (const bool kinematic : {false, true})
    for (const double speed : {0.5, 2.0, 4.0}) {
      His his;
      const dGeomID box = his.box({3, 3, 1}, {0, 0, -0.5});
      if (kinematic) {
        const dBodyID body = his.body(1.0, {0, 0, -0.5});
        dGeomSetBody(box, body);
        dBodySetKinematic(body);
      }
      OdeWorld ours(his.world, his.space, careful, kMaterials);
      const OdeBodyId crate = add_crate(ours, {0, 0, 0.2});
      step(ours, 60);
      for (int i = 1; i <= 60; ++i) {
        dGeomSetPosition(box, 0, 0, -0.5 + speed * i * kFrame);  // or its body
        step(ours, 1);
        EXPECT_NEAR(ours.state(crate).position.z(), 0.2 + speed * i * kFrame, speed * kFrame + 2e-3)
            << speed << " m/s, " << i;
      }
    }
}

TEST(CallersOdeWorld, WhatHePutsElsewhereOnceThrowsNobody) {
  OdeSettings careful = kSleeping;
  careful.max_correcting_velocity = 1.0;
  His his;
  const dGeomID box = his.box({3, 3, 1}, {0, 0, -0.5});
  OdeWorld ours(his.world, his.space, careful, kMaterials);
  const OdeBodyId crate = add_crate(ours, {0, 0, 0.2});
  step(ours, 60);
  dGeomSetPosition(box, 0, 0, -0.4);
  for (int i = 0; i < 60; ++i) {
    step(ours, 1);
    EXPECT_LT(ours.state(crate).velocity.z(), 1.01) << i;
  }
  EXPECT_NEAR(ours.state(crate).position.z(), 0.3, 2e-3);
}

TEST(CallersOdeWorld, OneOfHisThatComesWakesASleeper) {
  His his;
  dCreatePlane(his.space, 0, 0, 1, 0);
  const dBodyID ball = his.body(20.0, {-2, 0, 0.15});
  dGeomSetBody(dCreateSphere(his.space, 0.15), ball);
  dBodySetGravityMode(ball, 0);
  OdeWorld ours(his.world, his.space, kSleeping, kMaterials);
  const OdeBodyId crate = add_crate(ours, {0, 0, 0.2}), far = add_crate(ours, {0, 5, 0.2});
  step(ours, 60);
  ASSERT_TRUE(ours.asleep(crate) && ours.asleep(far));
  dBodySetLinearVel(ball, 4, 0, 0);
  step(ours, 40);
  EXPECT_GT(ours.state(crate).position.x(), 0.02);
  EXPECT_LT(dBodyGetLinearVel(ball)[0], 3.0);
  EXPECT_TRUE(ours.asleep(far));
}

TEST(OdeProperties, AreHonoured) {
  OdeWorld world({.auto_disable = true}, kMaterials);
  world.add_static_box({100, 100, 1}, {0, 0, -0.5}, Quat::Identity(), 0);
  const OdeBodyId floats = add_crate(world, {0, 0, 1}, {.gravity = false}),
                  kinematic = add_crate(world, {4, 0, 0.5}, {.kinematic = true});
  const OdeBodyId on_it = add_crate(world, {4, 0, 0.9}),
                  restless = add_crate(world, {8, 0, 0.2}, {.allow_sleep = false});
  const OdeBodyId damped =
      add_crate(world, {12, 0, 5}, {.gravity = false, .linear_damping = 2.0, .angular_damping = 3.0});
  const OdeBodyId spinning = add_crate(world, {16, 0, 5}, {.gravity = false, .max_angular_speed = 2.0});
  const OdeBodyId ghost = add_crate(world, {20, 0, 2}, {.category = 2, .collide = 0}),
                  hers = add_crate(world, {20, 0, 0.2}, {.category = 1, .collide = 1});
  world.set_state(kinematic, at({4, 0, 0.5}, {0.5, 0, 0}));
  world.set_state(damped, at({12, 0, 5}, {1, 0, 0}, {0, 0, 1}));
  world.set_state(spinning, at({16, 0, 5}, Vec3::Zero(), {0, 0, 7}));
  step(world, 60);
  EXPECT_EQ(world.state(floats).position.z(), 1.0);
  EXPECT_NEAR(world.state(kinematic).position.x(), 4.5, 1e-9);
  EXPECT_NEAR(world.state(kinematic).position.z(), 0.5, 1e-12);
  EXPECT_NEAR(world.state(on_it).position.x(), 4.5, 0.03);
  EXPECT_FALSE(world.asleep(restless));
  EXPECT_NEAR(world.state(damped).velocity.x(), std::exp(-2.0), 1e-9);
  EXPECT_NEAR(world.state(damped).angular_velocity.z(), std::exp(-3.0), 1e-9);
  EXPECT_LE(world.state(spinning).angular_velocity.norm(), 2.0 + 1e-9);
  // Of category 2, which the other does not collide with: they pass through each other. The ground, of every
  // bit, holds both.
  EXPECT_NEAR(world.state(ghost).position.z(), 0.2, 0.01);
  EXPECT_NEAR(world.state(hers).position.z(), 0.2, 0.01);
  world.set_properties(floats, {});
  step(world, 10);
  EXPECT_LT(world.state(floats).position.z(), 0.95);
  EXPECT_THROW(world.set_properties(floats, {.linear_damping = -1.0}), InputError);
  EXPECT_THROW(world.set_properties(floats, {.max_angular_speed = 0.0}), InputError);
}

TEST(OdeProperties, BitsHoldTowardsHisGeoms) {
  His his;
  dCreatePlane(his.space, 0, 0, 1, -3);
  const dGeomID floor = his.box({10, 10, 1}, {0, 0, -0.5});
  dGeomSetCategoryBits(floor, 4), dGeomSetCollideBits(floor, 0);
  OdeWorld ours(his.world, his.space, {}, kMaterials);
  const OdeBodyId through = add_crate(ours, {0, 0, 0.5}, {.category = 1, .collide = ~4u}),
                  on_it = add_crate(ours, {2, 0, 0.5}, {.category = 1, .collide = 4});
  step(ours, 120);
  EXPECT_NEAR(ours.state(on_it).position.z(), 0.2, 1e-3);
  EXPECT_NEAR(ours.state(through).position.z(), -2.8, 1e-3);
}

TEST(OdeProperties, PairFilterLetsThrough) {
  OdeWorld world({}, kMaterials);
  world.add_plane({0, 0, 1}, 0, 0);
  const OdeBodyId lower = add_crate(world, {0, 0, 0.2}), upper = add_crate(world, {0, 0, 0.8});
  world.set_pair_filter(
      [&](OdeBodyId a, OdeBodyId b) { return !(a == lower && b == upper) && !(a == upper && b == lower); });
  step(world, 120);
  EXPECT_NEAR(world.state(upper).position.z(), 0.2, 1e-3);
}

// Thrown out of ODE's own call it left its space locked, and the next step, or the end, aborted.
TEST(OdeProperties, APairFilterMayThrow) {
  OdeWorld world({}, kMaterials);
  world.add_plane({0, 0, 1}, 0, 0);
  add_crate(world, {0, 0, 0.2});
  const OdeBodyId upper = add_crate(world, {0, 0, 0.65});
  bool throws = true;
  world.set_pair_filter([&](OdeBodyId, OdeBodyId) {
    if (throws) throw std::runtime_error("the caller's own");
    return true;
  });
  EXPECT_THROW(step(world, 60), std::runtime_error);
  throws = false;
  step(world, 120);
  EXPECT_NEAR(world.state(upper).position.z(), 0.6, 2e-3);
}

TEST(OdeTouches, TellImpulsesAndApproach) {
  His his;
  const dGeomID floor = his.box({10, 10, 1}, {0, 0, -0.5});
  OdeWorld ours(his.world, his.space, {}, kMaterials);
  const OdeBodyId crate = add_crate(ours, {0, 0, 0.2 + 0.2});
  ours.step(kFrame, 4);
  EXPECT_TRUE(ours.touches().empty());
  ours.record_touches(true);
  double impulse = 0.0, approach = 0.0;
  for (int i = 0; i < 30; ++i) {
    ours.step(kFrame, 4);
    for (const OdeTouch& touch : ours.touches()) {
      EXPECT_EQ(touch.first, crate);
      EXPECT_EQ(touch.callers_geom, floor);
      EXPECT_GT(touch.normal.z(), 0.99);
      impulse += touch.impulse;
      approach = std::max(approach, touch.approach);
    }
  }
  EXPECT_NEAR(approach, std::sqrt(2 * kGravity * 0.2), 0.06);
  // What gravity gave in all 31 steps is what the floor took.
  EXPECT_NEAR(impulse, 64.0 * kGravity * 31 * kFrame, 0.02 * 64.0 * kGravity * 31 * kFrame);
  ASSERT_EQ(ours.touches().size(), 1u);
  EXPECT_TRUE(ours.touches()[0].at_end);
}

TEST(OdeGround, MovesCarriesAndGoes) {
  OdeWorld world(kSleeping, kMaterials);
  const OdeGroundId plane = world.add_plane({0, 0, 1}, -2, 0),
                    box = world.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity(), 0);
  const OdeBodyId crate = add_crate(world, {0, 0, 0.2}), far = add_crate(world, {9, 0, -1.8});
  step(world, 60);
  ASSERT_TRUE(world.asleep(crate) && world.asleep(far));
  double x = 0.0;
  for (int i = 0; i < 60; ++i) {
    world.move_ground(box, at({x, 0, -0.5}, {0.5, 0, 0}));
    world.step(kFrame, 4);
    x += 0.5 * kFrame;
  }
  EXPECT_NEAR(world.state(crate).position.x(), 0.5, 0.04);
  EXPECT_NEAR(world.state(crate).position.z(), 0.2, 1e-3);
  world.move_ground(box, at({x, 0, -0.5}));
  step(world, 60);
  ASSERT_TRUE(world.asleep(crate));
  EXPECT_THROW(world.move_ground(plane, {}), InputError);
  EXPECT_THROW(world.move_ground(box, at({std::nan(""), 0, 0})), InputError);
  world.remove_ground(box);
  EXPECT_THROW(world.remove_ground(box), InputError);
  step(world, 60);
  EXPECT_NEAR(world.state(crate).position.z(), -1.8, 2e-3);
  EXPECT_TRUE(world.asleep(far));
  step(world, 60);
  world.remove_ground(plane);
  step(world, 30);
  EXPECT_LT(world.state(crate).position.z(), -2.5);
  EXPECT_LT(world.state(far).position.z(), -2.5);
}

TEST(OdeGround, WhatIsPutOnAndOnLiftsAsFastAsItGoes) {
  OdeSettings careful = kSleeping;
  careful.max_correcting_velocity = 1.0;
  OdeWorld world(careful, kMaterials);
  const OdeGroundId box = world.add_static_box({2, 2, 1}, {0, 0, -0.5}, Quat::Identity(), 0);
  const OdeBodyId crate = add_crate(world, {0, 0, 0.2});
  constexpr double kSpeed = 3.0;  // m/s
  for (int i = 1; i <= 60; ++i) {
    world.move_ground(box, at({0, 0, -0.5 + kSpeed * i * kFrame}));
    step(world, 1);
    EXPECT_NEAR(world.state(crate).position.z(), 0.2 + kSpeed * i * kFrame, kSpeed * kFrame + 2e-3) << i;
  }
}

// His contacts last through all substeps at the depth that they were found with.
TEST(CallersContacts, HoldAtRestWhateverTheSubsteps) {
  for (const int substeps : {1, 4, 16, 64}) {
    His his;
    OdeWorld world(his.world, his.space, {}, kMaterials);
    const double erp = dWorldGetERP(his.world);
    const dBodyID box = his.body(10.0, {0, 0, 0.1});
    const dJointGroupID contacts = dJointGroupCreate(0);
    for (int i = 0; i < 120; ++i) {
      for (const double x : {-0.1, 0.1})
        for (const double y : {-0.1, 0.1}) {
          const double z = dBodyGetPosition(box)[2] - 0.1;
          if (z > 0.0) continue;
          dContact contact{};
          contact.surface.mode = dContactApprox1;
          contact.surface.mu = 0.5;
          contact.geom.pos[0] = x, contact.geom.pos[1] = y, contact.geom.pos[2] = z;
          contact.geom.normal[2] = 1.0;
          contact.geom.depth = -z;
          dJointAttach(dJointCreateContact(his.world, contacts, &contact), box, nullptr);
        }
      world.step(kFrame, substeps);
      dJointGroupEmpty(contacts);
      ASSERT_NEAR(dBodyGetPosition(box)[2], 0.1, 0.002) << substeps << " substeps, step " << i;
    }
    EXPECT_EQ(dWorldGetERP(his.world), erp);
    dJointGroupDestroy(contacts);
  }
}

}  // namespace
}  // namespace lodestone
