#include "reference/ode/joint_listener.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <array>

#include "reference/ode/body_joints.h"
#include "reference/ode/ode_world.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

constexpr double kMass = 2.0, kWeight = kMass * 9.81;  // kg, N

class JointListeners : public ::testing::Test {
 protected:
  dBodyID add(const Vec3& place) {
    return world_.ode_body(world_.add_body(
        {.shape = testing::box_shape({0.2, 0.2, 0.2}), .mass = kMass, .state = testing::at(place)}));
  }
  JointForce hear(dBodyID body) {
    const std::array bodies{body};
    listener_.listen(bodies);
    world_.step(1e-3);
    return listener_.stop().front();
  }
  MaterialTable materials_;
  OdeWorld world_{{}, materials_};
  JointListener listener_;
};

TEST_F(JointListeners, HearWhatHoldsABodyToAPlane) {
  const dBodyID body = add({0, 0, 0});
  const dJointID joint = dJointCreatePlane2D(dBodyGetWorld(body), nullptr);
  dJointAttach(joint, body, nullptr);
  const JointForce force = hear(body);
  EXPECT_NEAR(force.force.z(), kWeight, 1e-3 * kWeight);
  EXPECT_LT(force.torque.norm(), 1e-6);
  EXPECT_EQ(dJointGetFeedback(joint), nullptr);
}

// Its motor is find_joint_motors()'s.
TEST_F(JointListeners, DoNotHearALinearMotor) {
  const dBodyID body = add({0, 0, 1});
  const dJointID motor = dJointCreateLMotor(dBodyGetWorld(body), nullptr);
  dJointAttach(motor, body, nullptr);
  dJointSetLMotorNumAxes(motor, 1), dJointSetLMotorAxis(motor, 0, 0, 0, 0, 1);
  dJointSetLMotorParam(motor, dParamVel, 0.0), dJointSetLMotorParam(motor, dParamFMax, 1e3);
  const JointForce force = hear(body);
  EXPECT_LT(force.force.norm() + force.torque.norm(), 1e-9);
}

// Its motor is find_joint_motors()'s; about its axis it is free.
TEST_F(JointListeners, DoNotHearAPistonsMotor) {
  const dBodyID body = add({0, 0, 1});
  const dJointID piston = dJointCreatePiston(dBodyGetWorld(body), nullptr);
  dJointAttach(piston, body, nullptr);
  dJointSetPistonAnchor(piston, 0, 0, 1), dJointSetPistonAxis(piston, 0, 0, 1);
  dJointSetPistonParam(piston, dParamVel, 0.0), dJointSetPistonParam(piston, dParamFMax, 1e3);
  const JointForce force = hear(body);
  EXPECT_LT(force.force.norm() + force.torque.norm(), 1e-9);
}

// That is find_joint_rows()'s.
TEST_F(JointListeners, DoNotHearWhatAJointHolds) {
  const dBodyID ball = add({0, 0, 1}), fixed = add({2, 0, 1});
  join_bodies(ball, nullptr, JointKind::ball, {0, 0, 1});
  const dJointID joint = dJointCreateFixed(dBodyGetWorld(fixed), nullptr);
  dJointAttach(joint, fixed, nullptr);
  dJointSetFixed(joint);
  for (const dBodyID body : {ball, fixed}) {
    const JointForce force = hear(body);
    EXPECT_LT(force.force.norm() + force.torque.norm(), 1e-9);
  }
}

// A hard one is find_joint_stops()'s.
TEST_F(JointListeners, HearASliderAtASoftStopAlongItsAxis) {
  const dBodyID body = add({0, 0, 1});
  const dJointID slider = dJointCreateSlider(dBodyGetWorld(body), nullptr);
  dJointAttach(slider, body, nullptr);
  const Vec3 axis = Vec3(1, 0, 1).normalized();
  dJointSetSliderAxis(slider, axis.x(), axis.y(), axis.z());
  dJointSetSliderParam(slider, dParamLoStop, 0.0);
  dJointSetSliderParam(slider, dParamHiStop, 0.0);
  EXPECT_LT(hear(body).force.norm(), 1e-9);
  dJointSetSliderParam(slider, dParamStopCFM, 1e-8);
  const JointForce force = hear(body);
  EXPECT_LT((force.force - kWeight * axis.z() * axis).norm(), 1e-3 * kWeight);
}

TEST_F(JointListeners, OfWhoSleepsHearNothing) {
  const dBodyID body = add({0, 0, 1});
  join_bodies(body, nullptr, JointKind::ball, {0, 0, 1.1});
  hear(body);
  dBodyDisable(body);
  const JointForce force = hear(body);
  EXPECT_TRUE(force.force.isZero(0.0) && force.torque.isZero(0.0));
}

TEST_F(JointListeners, StopWhenTheyGo) {
  const dBodyID body = add({0, 0, 1});
  join_bodies(body, nullptr, JointKind::ball, {0, 0, 1});
  {
    JointListener listener;
    listener.listen(std::array{body});
    EXPECT_NE(dJointGetFeedback(dBodyGetJoint(body, 0)), nullptr);
  }
  EXPECT_EQ(dJointGetFeedback(dBodyGetJoint(body, 0)), nullptr);
}

}  // namespace
}  // namespace lodestone
