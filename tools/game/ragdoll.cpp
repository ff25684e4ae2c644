#include "tools/game/ragdoll.h"

#include <array>
#include <memory>

namespace game {
namespace {

using namespace lodestone;

struct Part {
  Vec3 sides, center;  // m, about the pelvis
};

enum PartName {
  pelvis,
  chest,
  head,
  left_arm,
  right_arm,
  left_forearm,
  right_forearm,
  left_thigh,
  right_thigh,
  left_shin,
  right_shin,
  part_count
};

// x to the left, y forward, z up.
const std::array<Part, part_count> kParts{{{{0.32, 0.20, 0.20}, {0, 0, 0}},
                                           {{0.36, 0.22, 0.40}, {0, 0, 0.33}},
                                           {{0.20, 0.20, 0.24}, {0, 0, 0.69}},
                                           {{0.12, 0.12, 0.30}, {0.26, 0, 0.36}},
                                           {{0.12, 0.12, 0.30}, {-0.26, 0, 0.36}},
                                           {{0.10, 0.10, 0.28}, {0.26, 0, 0.05}},
                                           {{0.10, 0.10, 0.28}, {-0.26, 0, 0.05}},
                                           {{0.15, 0.16, 0.40}, {0.10, 0, -0.33}},
                                           {{0.15, 0.16, 0.40}, {-0.10, 0, -0.33}},
                                           {{0.13, 0.14, 0.42}, {0.10, 0, -0.76}},
                                           {{0.13, 0.14, 0.42}, {-0.10, 0, -0.76}}}};

// Two angles, about the body's x and y axes, or for a hinge one; rad.
struct JointPlan {
  PartName upper, lower;
  Vec3 anchor;  // m, about the pelvis
  bool hinge;
  double least, greatest;
};

const std::array<JointPlan, part_count - 1> kJoints{
    {{pelvis, chest, {0, 0, 0.115}, false, -0.6, 0.6},
     {chest, head, {0, 0, 0.55}, false, -0.6, 0.6},
     {chest, left_arm, {0.22, 0, 0.49}, false, -1.4, 1.4},
     {chest, right_arm, {-0.22, 0, 0.49}, false, -1.4, 1.4},
     {left_arm, left_forearm, {0.26, 0, 0.20}, true, -2.3, 0.0},
     {right_arm, right_forearm, {-0.26, 0, 0.20}, true, -2.3, 0.0},
     {pelvis, left_thigh, {0.10, 0, -0.115}, false, -1.2, 1.2},
     {pelvis, right_thigh, {-0.10, 0, -0.115}, false, -1.2, 1.2},
     {left_thigh, left_shin, {0.10, 0, -0.54}, true, 0.0, 2.3},
     {right_thigh, right_shin, {-0.10, 0, -0.54}, true, 0.0, 2.3}}};
constexpr double kJointFriction = 3.0;  // N m

std::shared_ptr<const Shape> shape_of(int part) {
  static const auto shapes = [] {
    std::array<std::shared_ptr<const Shape>, part_count> made;
    for (int i = 0; i < part_count; ++i)
      made[i] = std::make_shared<const Shape>(make_shape("ragdoll part", make_box(kParts[i].sides)));
    return made;
  }();
  return shapes[part];
}

void add_joint(dWorldID world, const JointPlan& plan, dBodyID upper, dBodyID lower, const Vec3& anchor,
               const Quat& orientation) {
  const Vec3 x = orientation * Vec3::UnitX(), y = orientation * Vec3::UnitY();
  if (plan.hinge) {
    const dJointID joint = dJointCreateHinge(world, nullptr);
    dJointAttach(joint, upper, lower);
    dJointSetHingeAnchor(joint, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(joint, x.x(), x.y(), x.z());
    dJointSetHingeParam(joint, dParamLoStop, plan.least);
    dJointSetHingeParam(joint, dParamHiStop, plan.greatest);
    dJointSetHingeParam(joint, dParamFMax, kJointFriction);
    return;
  }
  const dJointID joint = dJointCreateUniversal(world, nullptr);
  dJointAttach(joint, upper, lower);
  dJointSetUniversalAnchor(joint, anchor.x(), anchor.y(), anchor.z());
  dJointSetUniversalAxis1(joint, x.x(), x.y(), x.z());
  dJointSetUniversalAxis2(joint, y.x(), y.y(), y.z());
  for (const int group : {dParamGroup1, dParamGroup2}) {
    dJointSetUniversalParam(joint, group | dParamLoStop, plan.least);
    dJointSetUniversalParam(joint, group | dParamHiStop, plan.greatest);
    dJointSetUniversalParam(joint, group | dParamFMax, kJointFriction);
  }
}

}  // namespace

std::vector<BodyId> add_ragdoll(Manager& manager, dWorldID world, const Vec3& pelvis_at,
                                const Quat& orientation, MaterialId material) {
  std::vector<BodyId> parts;
  for (int i = 0; i < part_count; ++i)
    parts.push_back(manager.add_body(
        {.shape = shape_of(i),
         .state = {.position = pelvis_at + orientation * kParts[i].center, .orientation = orientation},
         .material = material,
         .level = LevelChoice::full}));
  // A body that is forced full has its ODE body at once.
  for (const JointPlan& plan : kJoints)
    add_joint(world, plan, manager.ode_body(parts[plan.upper]), manager.ode_body(parts[plan.lower]),
              pelvis_at + orientation * plan.anchor, orientation);
  return parts;
}

}  // namespace game
