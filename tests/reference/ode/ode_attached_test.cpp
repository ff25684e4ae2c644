// Our bodies in a world that somebody else made with plain ODE.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// What a user of plain ODE has: a world, a space, a floor, and contacts of his own.
class AttachedOdeWorld : public ::testing::Test {
 protected:
  AttachedOdeWorld() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    space = dHashSpaceCreate(nullptr);
    contacts = dJointGroupCreate(0);
    dWorldSetGravity(world, 0, 0, -kGravity);
  }
  ~AttachedOdeWorld() override {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }

  dBodyID add_sphere(double radius, double mass, const Vec3& position) {
    const dBodyID body = dBodyCreate(world);
    dMass parameters;
    dMassSetSphereTotal(&parameters, mass, radius);
    dBodySetMass(body, &parameters);
    dBodySetPosition(body, position.x(), position.y(), position.z());
    dGeomSetBody(dCreateSphere(space, radius), body);
    return body;
  }

  // His own collision detection, as ODE's manual has it; counts what it meets.
  void collide_his_own() {
    dJointGroupEmpty(contacts);
    met = 0;
    dSpaceCollide(space, this,
                  [](void* self, dGeomID a, dGeomID b) { static_cast<AttachedOdeWorld*>(self)->meet(a, b); });
  }
  void meet(dGeomID a, dGeomID b) {
    ++met;
    dContact contact{};
    contact.surface.mu = 0.5;
    if (dCollide(a, b, 1, &contact.geom, sizeof contact) > 0)
      dJointAttach(dJointCreateContact(world, contacts, &contact), dGeomGetBody(a), dGeomGetBody(b));
  }

  static double height_of(dBodyID body) { return dBodyGetPosition(body)[2]; }

  dWorldID world;
  dSpaceID space;
  dJointGroupID contacts;
  int met = 0;
  const MaterialTable materials = material(0.0, 0.5);
};

TEST_F(AttachedOdeWorld, OurBodyRestsOnHisPlaneBoxAndMesh) {
  dCreatePlane(space, 0, 0, 1, 0);
  dGeomSetPosition(dCreateBox(space, 2, 2, 1), 5, 0, 0.5);
  const auto shape = box_shape({0.4, 0.4, 0.4});
  OdeWorld ours(world, space, {}, materials);
  const OdeBodyId on_plane = ours.add_body({.shape = shape, .mass = 64.0, .state = at({0, 0, 0.25})});
  const OdeBodyId on_box = ours.add_body({.shape = shape, .mass = 64.0, .state = at({5, 0, 1.25})});
  for (int i = 0; i < 120; ++i) ours.step(1.0 / 60, 2);
  EXPECT_NEAR(ours.state(on_plane).position.z(), 0.2, 1e-3);
  EXPECT_NEAR(ours.state(on_box).position.z(), 1.2, 2e-3);
}

TEST_F(AttachedOdeWorld, HisBodyIsMetAndStepped) {
  dCreatePlane(space, 0, 0, 1, 0);
  const auto shape = box_shape({1, 1, 0.4});
  OdeWorld ours(world, space, {}, materials);
  const OdeBodyId box = ours.add_body({.shape = shape, .mass = 400.0, .state = at({0, 0, 0.2})});
  const dBodyID ball = add_sphere(0.1, 4.0, {0, 0, 0.8});
  for (int i = 0; i < 120; ++i) ours.step(1.0 / 60, 2);
  EXPECT_NEAR(height_of(ball), 0.5, 5e-3);
  bool met_his = false;
  for (const OdeContact& contact : ours.contacts())
    if (contact.first == box && !contact.second && contact.point.z() > 0.3) {
      met_his = true;
      EXPECT_LT(contact.normal.z(), -0.99);  // into the box, from the ball above it
    }
  EXPECT_TRUE(met_his);
}

TEST_F(AttachedOdeWorld, HisOwnContactsStayHis) {
  const dGeomID floor = dCreatePlane(space, 0, 0, 1, 0);
  const dBodyID ball = add_sphere(0.1, 4.0, {3, 0, 0.1});
  {
    OdeWorld ours(world, space, {}, materials);
    const OdeBodyId box =
        ours.add_body({.shape = box_shape({0.4, 0.4, 0.4}), .mass = 64.0, .state = at({0, 0, 0.2})});
    for (int i = 0; i < 60; ++i) {
      collide_his_own();
      EXPECT_EQ(met, 1) << "his collision detection met one of our geoms";
      ours.step(1.0 / 60);
    }
    EXPECT_NEAR(height_of(ball), 0.1, 1e-3);  // held by his contact alone
    EXPECT_NEAR(ours.state(box).position.z(), 0.2, 1e-3);
    EXPECT_TRUE(dSpaceQuery(space, floor));
  }
  // Ours are gone, his are there and go on.
  EXPECT_EQ(dSpaceGetNumGeoms(space), 2);
  collide_his_own();
  dWorldStep(world, 1.0 / 60);
  EXPECT_NEAR(height_of(ball), 0.1, 1e-3);
}

TEST_F(AttachedOdeWorld, SettingsOfHisWorldStayHis) {
  dWorldSetContactMaxCorrectingVel(world, 3.0);
  dWorldSetQuickStepNumIterations(world, 33);
  OdeWorld ours(world, space,
                {.gravity = Vec3::Zero(), .quick_step_iterations = 5, .max_correcting_velocity = 1.0},
                materials);
  ours.step(1.0 / 60);
  dVector3 gravity;
  dWorldGetGravity(world, gravity);
  EXPECT_EQ(gravity[2], -kGravity);
  EXPECT_EQ(dWorldGetContactMaxCorrectingVel(world), 3.0);
  EXPECT_EQ(dWorldGetQuickStepNumIterations(world), 33);
}

TEST_F(AttachedOdeWorld, RemovalWakesHisBody) {
  const auto shape = box_shape({1, 1, 0.4});
  OdeWorld ours(world, space, {}, materials);
  const OdeBodyId box = ours.add_body({.shape = shape, .mass = 400.0, .state = at({0, 0, 0.2})});
  const dBodyID ball = add_sphere(0.1, 4.0, {0, 0, 0.499});
  const dBodyID far = add_sphere(0.1, 4.0, {9, 0, 0.499});
  dBodyDisable(ball), dBodyDisable(far);
  ours.remove_body(box);
  ours.step(1.0 / 60);
  EXPECT_TRUE(dBodyIsEnabled(ball));
  EXPECT_FALSE(dBodyIsEnabled(far));
}

TEST_F(AttachedOdeWorld, HisJointHoldsOurBody) {
  OdeWorld ours(world, space, {}, materials);
  const OdeBodyId box =
      ours.add_body({.shape = box_shape({0.4, 0.4, 0.4}), .mass = 64.0, .state = at({0, 0, 5})});
  const dJointID joint = dJointCreateBall(world, nullptr);
  dJointAttach(joint, ours.ode_body(box), nullptr);
  dJointSetBallAnchor(joint, 0, 0, 5);
  for (int i = 0; i < 60; ++i) ours.step(1.0 / 60);
  EXPECT_NEAR(ours.state(box).position.z(), 5.0, 1e-3);
  ours.remove_body(box);
  EXPECT_EQ(dJointGetBody(joint, 0), nullptr);
  dJointDestroy(joint);
}

TEST_F(AttachedOdeWorld, MessagesOutsideItsStepsAreNotTheWorlds) {
  OdeWorld ours({}, materials);
  ::testing::internal::CaptureStderr();
  dMessage(1, "as ODE would say it");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(ours.counters().messages, 0);
}

}  // namespace
}  // namespace lodestone
