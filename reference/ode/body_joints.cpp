#include "reference/ode/body_joints.h"

#include <ode/ode.h>

namespace lodestone {

std::vector<dxBody*> joined_bodies(dxBody* body) {
  std::vector<dxBody*> joined;
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    if (dJointGetType(joint) == dJointTypeContact) continue;
    const dBodyID first = dJointGetBody(joint, 0);
    joined.push_back(first == body ? dJointGetBody(joint, 1) : first);
  }
  return joined;
}

bool has_joints(dxBody* body) { return dBodyGetNumJoints(body) > 0 && !joined_bodies(body).empty(); }

void join_bodies(dxBody* first, dxBody* second, JointKind kind, const Vec3& anchor, const Vec3& axis) {
  const dWorldID world = dBodyGetWorld(first);
  const dJointID joint =
      kind == JointKind::ball ? dJointCreateBall(world, nullptr) : dJointCreateHinge(world, nullptr);
  dJointAttach(joint, first, second);
  if (kind == JointKind::ball) {
    dJointSetBallAnchor(joint, anchor.x(), anchor.y(), anchor.z());
    return;
  }
  dJointSetHingeAnchor(joint, anchor.x(), anchor.y(), anchor.z());
  dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
}

}  // namespace lodestone
