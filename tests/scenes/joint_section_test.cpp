#include <gtest/gtest.h>

#include "tests/scenes/scene_sections.h"

namespace lodestone {
namespace {

class JointSection : public SceneFixture {
 protected:
  static std::string text(const std::string& joint) {
    return testing::scene_of(
        "bodies:\n  - {shape: crate, position_m: [0, 0, 5], name: door}\n"
        "  - {shape: ball, position_m: [3, 0, 5], name: frame, level: full}\n"
        "  - {shape: ball, position_m: [6, 0, 5], name: far, level: statistical}\n"
        "  - {shape: ball, position_m: [-3, 0, 5], name: low, greatest_rung: support}\n"
        "  - {shape: ball, position_m: [9, 0, 5], name: twin}\n  - {shape: ball, position_m: [12, 0, 5], "
        "name: twin}\n"
        "joints: [" +
        joint + "]\n");
  }
  SceneJoint made(const std::string& joint) const { return load(text(joint)).joints.at(0); }
  std::string fault(const std::string& joint) const { return error_of(text(joint)); }
};

TEST_F(JointSection, BodiesAreFoundByTheirNames) {
  const SceneJoint hinge = made("{hinge: [door, frame], at_m: [1, 0, 5], axis: [0, 0, 2]}");
  EXPECT_EQ(hinge.kind, JointKind::hinge);
  EXPECT_EQ(hinge.first, 0);
  EXPECT_EQ(hinge.second, 1);
  EXPECT_EQ(hinge.anchor_m, Vec3(1, 0, 5));
  EXPECT_EQ(hinge.axis, Vec3(0, 0, 1));
  const SceneJoint ball = made("{ball: [door], at_m: [0, 0, 7]}");
  EXPECT_EQ(ball.kind, JointKind::ball);
  EXPECT_EQ(ball.second, SceneJoint::kWorld);
}

// Those that a joint holds are full throughout.
TEST_F(JointSection, TheirBodiesAreFull) {
  const Scene scene = load(text("{ball: [door, frame], at_m: [1, 0, 5]}"));
  EXPECT_EQ(scene.bodies[0].definition.level, LevelChoice::full);
  EXPECT_EQ(scene.bodies[1].definition.level, LevelChoice::full);
  EXPECT_EQ(scene.bodies[3].definition.level, LevelChoice::automatic);
  for (const char* other : {"far", "low"})
    EXPECT_NE(fault(std::string("{ball: [door, ") + other + "], at_m: [1, 0, 5]}")
                  .find("expected a body that may be full"),
              std::string::npos);
}

TEST_F(JointSection, WhatCannotBeIsSaid) {
  EXPECT_NE(fault("{ball: [dor], at_m: [0, 0, 0]}").find("did you mean \"door\"?"), std::string::npos);
  EXPECT_NE(fault("{ball: [twin], at_m: [0, 0, 0]}").find("which several bodies are called"),
            std::string::npos);
  EXPECT_NE(fault("{ball: [door, door], at_m: [0, 0, 0]}").find("door a second time"), std::string::npos);
  EXPECT_NE(fault("{ball: [], at_m: [0, 0, 0]}"), testing::kNothingThrown);
  EXPECT_NE(fault("{ball: [door, frame, far], at_m: [0, 0, 0]}"), testing::kNothingThrown);
  EXPECT_NE(fault("{ball: [door], at_m: [0, 0, 0], axis: [0, 0, 1]}").find("the axis of a ball joint"),
            std::string::npos);
  EXPECT_NE(fault("{hinge: [door], at_m: [0, 0, 0]}").find("axis"), std::string::npos);
  EXPECT_NE(fault("{hinge: [door], at_m: [0, 0, 0], axis: [0, 0, 0]}"), testing::kNothingThrown);
  EXPECT_NE(fault("{ball: [door]}").find("at_m"), std::string::npos);
  EXPECT_NE(fault("{slider: [door], at_m: [0, 0, 0]}"), testing::kNothingThrown);
}

}  // namespace
}  // namespace lodestone
