#include "reference/ode/body_joints.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>

#include "reference/ode/ode_world.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using testing::at;

class BodyJoints : public ::testing::Test {
 protected:
  OdeBodyId add(const Vec3& place) {
    return world_.add_body({.shape = testing::box_shape({0.2, 0.2, 0.2}), .state = at(place)});
  }
  dxBody* body(OdeBodyId id) const { return world_.ode_body(id); }
  MaterialTable materials_;
  OdeWorld world_{{}, materials_};
};

TEST_F(BodyJoints, AreToldFromBothEnds) {
  const OdeBodyId a = add({0, 0, 1}), b = add({0.3, 0, 1}), c = add({0.6, 0, 1});
  EXPECT_FALSE(has_joints(body(a)));
  join_bodies(body(a), body(b), JointKind::ball, {0.15, 0, 1});
  join_bodies(body(b), body(c), JointKind::hinge, {0.45, 0, 1}, Vec3::UnitY());
  EXPECT_EQ(joined_bodies(body(a)), std::vector{body(b)});
  EXPECT_EQ(joined_bodies(body(c)), std::vector{body(b)});
  std::vector<dxBody*> of_b = joined_bodies(body(b)), expected{body(a), body(c)};
  std::ranges::sort(of_b), std::ranges::sort(expected);
  EXPECT_EQ(of_b, expected);
  for (const OdeBodyId id : {a, b, c}) EXPECT_TRUE(has_joints(body(id)));
}

TEST_F(BodyJoints, ToTheWorldIsNull) {
  const OdeBodyId a = add({0, 0, 1});
  join_bodies(body(a), nullptr, JointKind::ball, {0, 0, 1.1});
  EXPECT_EQ(joined_bodies(body(a)), std::vector<dxBody*>{nullptr});
  EXPECT_TRUE(has_joints(body(a)));
}

TEST_F(BodyJoints, ContactsAreNone) {
  const OdeBodyId a = add({0, 0, 1}), b = add({0.3, 0, 1});
  dContact contact{};
  contact.surface.mu = 1.0;
  contact.geom.normal[2] = 1.0;
  const dJointID joint = dJointCreateContact(dBodyGetWorld(body(a)), nullptr, &contact);
  dJointAttach(joint, body(a), body(b));
  EXPECT_EQ(dBodyGetNumJoints(body(a)), 1);
  EXPECT_TRUE(joined_bodies(body(a)).empty());
  EXPECT_FALSE(has_joints(body(b)));
  dJointDestroy(joint);
}

TEST_F(BodyJoints, HoldTheseDirections) {
  const OdeBodyId a = add({0, 0, 1}), b = add({0.3, 0, 1});
  const auto rows_of = [&](OdeBodyId id) {
    std::vector<JointRow> rows;
    find_joint_rows(body(id), 0.2, rows);
    return rows;
  };
  EXPECT_TRUE(rows_of(a).empty());
  join_bodies(body(a), body(b), JointKind::ball, {0.15, 0, 1});
  ASSERT_EQ(rows_of(a).size(), 3u);  // of the first body alone
  EXPECT_TRUE(rows_of(b).empty());
  for (const JointRow& row : rows_of(a)) {
    EXPECT_EQ(row.second, body(b));
    EXPECT_NEAR((row.point - Vec3(0.15, 0, 1)).norm(), 0.0, 1e-12);
  }
  join_bodies(body(b), nullptr, JointKind::hinge, {0.45, 0, 1}, Vec3::UnitY());
  const std::vector<JointRow> hinged = rows_of(b);
  ASSERT_EQ(hinged.size(), 6u);
  for (const JointRow& row : hinged) {
    EXPECT_EQ(row.second, nullptr);
    EXPECT_NEAR(std::abs(row.point.y()), 0.1, 1e-12);
  }
  dJointDisable(dBodyGetJoint(body(b), 0)), dJointDisable(dBodyGetJoint(body(b), 1));
  EXPECT_TRUE(rows_of(b).empty());
}

TEST_F(BodyJoints, ASliderHoldsAllButItsAxis) {
  const OdeBodyId a = add({0, 0, 1});
  const dJointID slider = dJointCreateSlider(dBodyGetWorld(body(a)), nullptr);
  dJointAttach(slider, body(a), nullptr);
  dJointSetSliderAxis(slider, 0, 1, 0);
  std::vector<JointRow> rows;
  find_joint_rows(body(a), 0.2, rows);
  ASSERT_EQ(rows.size(), 5u);
  for (const JointRow& row : rows) EXPECT_NEAR(row.direction.y(), 0.0, 1e-12);
}

// At the wheel's own anchor, which the spring lets go away from the chassis'.
TEST_F(BodyJoints, AWheelIsHeldButForTheWayOfItsSpring) {
  const OdeBodyId chassis = add({0, 0, 1}), wheel = add({0.5, 0, 0.8});
  const dJointID axle = dJointCreateHinge2(dBodyGetWorld(body(chassis)), nullptr);
  dJointAttach(axle, body(chassis), body(wheel));
  dJointSetHinge2Anchor(axle, 0.5, 0, 0.8);
  const dVector3 up = {0, 0, 1}, across = {0, 1, 0};
  dJointSetHinge2Axes(axle, up, across);
  dJointSetHinge2Param(axle, dParamVel2, 3.0), dJointSetHinge2Param(axle, dParamFMax2, 5.0);
  dBodySetPosition(body(wheel), 0.5, 0, 0.7);
  const auto find = [&] {
    std::vector<JointRow> rows;
    find_joint_rows(body(chassis), 0.2, rows);
    return rows;
  };
  std::vector<JointMotor> motors;
  find_joint_motors(body(chassis), 0.2, motors);
  ASSERT_EQ(motors.size(), 1u);
  EXPECT_NEAR(motors[0].speed, 0.6, 1e-12);
  EXPECT_NEAR(motors[0].force, 25.0, 1e-12);
  EXPECT_NEAR(motors[0].direction.y(), 0.0, 1e-12);
  EXPECT_EQ(find().size(), 3u);
  dJointSetHinge2Param(axle, dParamSuspensionERP, 0.1);
  dJointSetHinge2Param(axle, dParamSuspensionCFM, 1e-3);  // stops 21 kg within a frame
  EXPECT_EQ(find().size(), 3u);
  EXPECT_TRUE(has_motor(axle));
  dJointSetHinge2Param(axle, dParamSuspensionCFM, 0.1);
  const std::vector<JointRow> sprung = find();
  ASSERT_EQ(sprung.size(), 2u);
  for (const JointRow& row : sprung) {
    EXPECT_NEAR((row.point - Vec3(0.5, 0, 0.7)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(row.direction.z(), 0.0, 1e-12);
  }
  EXPECT_FALSE(has_motor(axle));
}

// A pendulum swings about its anchor at a constant distance; a hinge lets it turn about one axis alone.
TEST_F(BodyJoints, APendulumKeepsItsLength) {
  const Vec3 anchor(0, 0, 2);
  for (const JointKind kind : {JointKind::ball, JointKind::hinge}) {
    const OdeBodyId a = add({0.4, kind == JointKind::ball ? 0.0 : 5.0, 1.7});
    const Vec3 there = anchor + Vec3(0, kind == JointKind::ball ? 0.0 : 5.0, 0);
    join_bodies(body(a), nullptr, kind, there, Vec3::UnitY());
    double lowest = 2.0;
    for (int step = 0; step < 240; ++step) {
      world_.step(1.0 / 480);
      const RigidState state = world_.state(a);
      EXPECT_NEAR((state.position - there).norm(), 0.5, 1e-3);
      if (kind == JointKind::hinge) {
        EXPECT_NEAR(state.angular_velocity.x(), 0.0, 1e-6);
        EXPECT_NEAR(state.angular_velocity.z(), 0.0, 1e-6);
      }
      lowest = std::min(lowest, state.position.z());
    }
    EXPECT_LT(lowest, 1.52);  // it came by below the anchor
  }
}

// Whichever end of the joint it is.
TEST_F(BodyJoints, MotorsReachTheirSpeed) {
  for (const bool is_first : {true, false})
    for (const bool is_hinge : {true, false}) {
      MaterialTable materials;
      OdeWorld world({.gravity = Vec3::Zero()}, materials);
      const dBodyID body = world.ode_body(
          world.add_body({.shape = testing::box_shape({0.2, 0.2, 0.2}), .state = at({0, 0, 1})}));
      const dJointID joint = is_hinge ? dJointCreateHinge(dBodyGetWorld(body), nullptr)
                                      : dJointCreateSlider(dBodyGetWorld(body), nullptr);
      dJointAttach(joint, is_first ? body : nullptr, is_first ? nullptr : body);
      if (is_hinge) {
        dJointSetHingeAnchor(joint, 0, 0, 1), dJointSetHingeAxis(joint, 0, 0, 1);
        dJointSetHingeParam(joint, dParamVel, 0.7), dJointSetHingeParam(joint, dParamFMax, 1e3);
      } else {
        dJointSetSliderAxis(joint, 1, 0, 0);
        dJointSetSliderParam(joint, dParamVel, 0.7), dJointSetSliderParam(joint, dParamFMax, 1e3);
      }
      std::vector<JointMotor> motors;
      find_joint_motors(body, 0.1, motors);
      ASSERT_EQ(motors.size(), 1u);
      const JointMotor& motor = motors.front();
      world.step(1e-3);
      dVector3 velocity;
      dBodyGetPointVel(body, motor.point.x(), motor.point.y(), motor.point.z(), velocity);
      EXPECT_NEAR(Vec3(velocity[0], velocity[1], velocity[2]).dot(motor.direction), motor.speed, 1e-4)
          << is_first << is_hinge;
      EXPECT_GT(motor.speed, 0.0);
      EXPECT_NEAR(motor.force, is_hinge ? 1e4 : 1e3, 1e-6);
    }
}

TEST_F(BodyJoints, AMotorAtASoftStopOrSwitchedOffIsNone) {
  const OdeBodyId a = add({0, 0, 1});
  const dJointID slider = dJointCreateSlider(dBodyGetWorld(body(a)), nullptr);
  dJointAttach(slider, body(a), nullptr);
  dJointSetSliderAxis(slider, 1, 0, 0);
  EXPECT_FALSE(has_motor(slider));  // no force
  dJointSetSliderParam(slider, dParamFMax, 10.0);
  EXPECT_TRUE(has_motor(slider));
  dJointDisable(slider);
  EXPECT_FALSE(has_motor(slider));
  dJointEnable(slider);
  dJointSetSliderParam(slider, dParamHiStop, 0.0);
  EXPECT_TRUE(has_motor(slider));  // it goes on pushing, and the stop is known
  dJointSetSliderParam(slider, dParamStopCFM, 1e-3);
  EXPECT_FALSE(has_motor(slider));
}

TEST_F(BodyJoints, StopsOfASliderAreThoseWithinReach) {
  for (const bool is_first : {true, false}) {
    const OdeBodyId a = add({0, 0, 1});
    const dJointID slider = dJointCreateSlider(dBodyGetWorld(body(a)), nullptr);
    dJointAttach(slider, is_first ? body(a) : nullptr, is_first ? nullptr : body(a));
    dJointSetSliderAxis(slider, 0, 0, 1);
    dBodySetPosition(body(a), 0, 0, 1.5);
    const double position = dJointGetSliderPosition(slider);
    dJointSetSliderParam(slider, dParamLoStop, position - 0.03);
    dJointSetSliderParam(slider, dParamHiStop, position + 0.4);
    std::vector<JointStop> stops;
    find_joint_stops(body(a), 0.1, stops);
    ASSERT_EQ(stops.size(), 1u);
    EXPECT_NEAR(stops[0].gap, 0.03, 1e-9);
    dBodySetPosition(body(a), 0, 0, 1.5 + 0.03 * stops[0].direction.z());  // away from it
    EXPECT_GT(std::abs(dJointGetSliderPosition(slider) - (position - 0.03)), 0.05);
    stops.clear();
    find_joint_stops(body(a), 1.0, stops);
    EXPECT_EQ(stops.size(), 2u);
    stops.clear();
    dJointSetSliderParam(slider, dParamStopCFM, 1e-3);
    find_joint_stops(body(a), 1.0, stops);
    EXPECT_TRUE(stops.empty());
  }
}

}  // namespace
}  // namespace lodestone
