#include "reference/ode/joint_listener.h"

#include <ode/ode.h>

#include <deque>
#include <unordered_set>

#include "reference/ode/body_joints.h"
#include "reference/ode/geometry_ode.h"

namespace lodestone {
namespace {

template <class Get>
Vec3 read_vector(dJointID joint, Get get) {
  dVector3 v;
  get(joint, v);
  return ode::to_vec3(v);
}

// Of all that the joint gives, what find_joint_rows() and find_joint_stops() do not hold and
// find_joint_motors() does not drive.
JointForce free_part_of(dJointID joint, const JointForce& all, const Vec3& position) {
  const auto about = [&](const Vec3& anchor) {
    return Vec3(all.torque - (anchor - position).cross(all.force));
  };
  switch (dJointGetType(joint)) {
    case dJointTypeContact:
    case dJointTypeFixed:
      return {};
    case dJointTypeSlider: {
      if (has_motor(joint) || has_hard_stops(joint)) return {};
      const Vec3 axis = read_vector(joint, dJointGetSliderAxis);
      return {.force = axis.dot(all.force) * axis};
    }
    case dJointTypePiston: {
      const Vec3 axis = read_vector(joint, dJointGetPistonAxis),
                 anchor = read_vector(joint, dJointGetPistonAnchor), turning = axis.dot(about(anchor)) * axis;
      if (has_motor(joint) || has_hard_stops(joint)) return {.torque = turning};
      const Vec3 along = axis.dot(all.force) * axis;
      return {.force = along, .torque = turning + (anchor - position).cross(along)};
    }
    case dJointTypeHinge: {
      if (has_motor(joint) || has_hard_stops(joint)) return {};
      const Vec3 axis = read_vector(joint, dJointGetHingeAxis);
      return {.torque = axis.dot(about(read_vector(joint, dJointGetHingeAnchor))) * axis};
    }
    case dJointTypeLMotor:
      return has_motor(joint) ? JointForce{} : all;
    case dJointTypePR: {
      if (!dJointGetBody(joint, 0)) return all;
      const Vec3 along_axis = read_vector(joint, dJointGetPRAxis1),
                 turning_axis = read_vector(joint, dJointGetPRAxis2),
                 anchor = read_vector(joint, dJointGetPRAnchor),
                 turning = turning_axis.dot(about(anchor)) * turning_axis;
      if (has_motor(joint)) return {.torque = turning};
      const Vec3 along = along_axis.dot(all.force) * along_axis;
      return {.force = along, .torque = turning + (anchor - position).cross(along)};
    }
    case dJointTypeBall:
      return {.torque = about(read_vector(joint, dJointGetBallAnchor))};
    case dJointTypeUniversal:
      return {.torque = about(read_vector(joint, dJointGetUniversalAnchor))};
    case dJointTypeHinge2: {
      const Vec3 anchor = read_vector(joint, dJointGetHinge2Anchor2),
                 up = read_vector(joint, dJointGetHinge2Axis1),
                 turning = read_vector(joint, dJointGetHinge2Axis2);
      const Vec3 spring = is_sprung(joint) ? Vec3(up.dot(all.force) * up) : Vec3(Vec3::Zero());
      Vec3 torque = about(anchor);
      if (has_motor(joint)) torque -= turning.dot(torque) * turning;
      return {.force = spring, .torque = torque + (anchor - position).cross(spring)};
    }
    default:
      return all;
  }
}

template <class Visit>
void each_joint(dBodyID body, const Visit& visit) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) visit(dBodyGetJoint(body, i));
}

}  // namespace

struct JointListener::Feedback {
  std::deque<dJointFeedback> of_joints;  // which stay where they are
  std::unordered_set<const dJointFeedback*> places;
  std::size_t used = 0;

  dJointFeedback* take() {
    if (used == of_joints.size()) places.insert(&of_joints.emplace_back());
    dJointFeedback& taken = of_joints[used++];
    taken = {};
    return &taken;
  }
};

JointListener::JointListener() : feedback_(std::make_unique<Feedback>()) {}
JointListener::~JointListener() {
  if (feedback_) stop();
}
JointListener::JointListener(JointListener&&) noexcept = default;
JointListener& JointListener::operator=(JointListener&&) noexcept = default;

void JointListener::listen(std::span<dxBody* const> bodies) {
  stop();
  bodies_.assign(bodies.begin(), bodies.end());
  for (const dBodyID body : bodies_)
    each_joint(body, [&](dJointID joint) {
      if (dJointGetType(joint) != dJointTypeContact && !dJointGetFeedback(joint))
        dJointSetFeedback(joint, feedback_->take());
    });
}

std::span<const JointForce> JointListener::stop() {
  forces_.assign(bodies_.size(), {});
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const dBodyID body = bodies_[i];
    if (!dBodyIsEnabled(body)) continue;
    const Vec3 position = ode::to_vec3(dBodyGetPosition(body));
    each_joint(body, [&](dJointID joint) {
      const dJointFeedback* feedback = dJointGetFeedback(joint);
      if (!feedback || !dJointIsEnabled(joint)) return;
      const bool is_second = dJointGetBody(joint, 0) && dJointGetBody(joint, 0) != body;
      const JointForce all{ode::to_vec3(is_second ? feedback->f2 : feedback->f1),
                           ode::to_vec3(is_second ? feedback->t2 : feedback->t1)};
      const JointForce given = free_part_of(joint, all, position);
      forces_[i].force += given.force, forces_[i].torque += given.torque;
    });
  }
  for (const dBodyID body : bodies_)
    each_joint(body, [&](dJointID joint) {
      if (feedback_->places.contains(dJointGetFeedback(joint))) dJointSetFeedback(joint, nullptr);
    });
  bodies_.clear();
  feedback_->used = 0;
  return forces_;
}

}  // namespace lodestone
