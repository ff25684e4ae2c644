// The joints that a caller has put on an ODE body, and those of a scene.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/geometry.h"

struct dxBody;
struct dxJoint;

namespace lodestone {

/// The bodies that `body` is joined to, one for each joint; null for the world. Contact joints are left out.
/// To be asked outside of a step.
std::vector<dxBody*> joined_bodies(dxBody* body);
/// Whether there are any.
bool has_joints(dxBody* body);
/// Whether one is between the two, which then do not meet each other.
bool are_joined(dxBody* first, dxBody* second);
/// `body` and all that hang together with it by such joints, through any but kinematic bodies. To be asked
/// outside of a step.
std::vector<dxBody*> find_jointed_group(dxBody* body);

/// Whether what a joint between them brings onto `holder` does not move it: it is kinematic and `body` is
/// not, or a joint fixes it, and not `body`, to the world or to one that is kinematic.
bool holds_fast(dxBody* holder, dxBody* body);

/// A direction (unit, world) in which a joint holds a point of one body to that of another.
struct JointRow {
  dxBody* second = nullptr;   ///< null: the world
  Vec3 point = Vec3::Zero();  ///< m, world
  Vec3 direction = Vec3::UnitZ();
};

/// Appends what the joints hold whose first body is `body`, or whose only one: of a ball joint its anchor, of
/// a hinge two points of its axis, of a fixed joint three points, of a slider all but the way along its axis,
/// of a piston what a slider holds but for turning about it, of a PR joint but for turning about its second
/// axis; a universal joint and a wheel's (hinge 2) count as ball joints, the latter but for the way along
/// which it is sprung. Others, limits, motors, and joints that are disabled are left out. Points are `reach`
/// m apart. To be asked outside of a step.
void find_joint_rows(dxBody* body, double reach, std::vector<JointRow>& rows);

/// A motor that drives a point of one body along a direction, against a point of another.
struct JointMotor {
  dxBody* second = nullptr;   ///< null: the world
  Vec3 point = Vec3::Zero();  ///< m, world
  Vec3 direction = Vec3::UnitZ();
  double speed = 0.0, force = 0.0;  ///< m/s along it, N at most
};

/// Appends those of sliders, pistons, PR joints along their first axis, LMotors along each of theirs, hinges
/// and unsprung wheels (hinge 2, which turn them) whose first body is `body`, or whose only one; a hinge's at
/// a point `reach` m from its axis. Not of those that stand at a soft stop. To be asked outside of a step.
void find_joint_motors(dxBody* body, double reach, std::vector<JointMotor>& motors);
/// Whether find_joint_motors() has the joint's, of a PR joint that along its first axis.
bool has_motor(dxJoint* joint);

/// Beyond which a point of one body does not go along a direction, against a point of another.
struct JointStop {
  dxBody* second = nullptr;        ///< null: the world
  Vec3 point = Vec3::Zero();       ///< m, world
  Vec3 direction = Vec3::UnitZ();  ///< that of its push on the first body
  double gap = 0.0;                ///< m
};

/// Appends the hard stops of sliders, pistons and hinges whose first body is `body`, or whose only one, that
/// are within `reach` m; a hinge's at a point so far from its axis. To be asked outside of a step.
void find_joint_stops(dxBody* body, double reach, std::vector<JointStop>& stops);
/// Whether it is a slider or hinge whose stops, if it has any, are as hard as the world's joints: a softer
/// one is a spring.
bool has_hard_stops(dxJoint* joint);

/// Whether a motor of the joint, of any kind that has parameters, is to bring it to a speed other than 0.
bool is_driven(dxJoint* joint);

/// Whether a wheel's joint (hinge 2) gives way along its first axis: its suspension is softer than the
/// world's joints, and does not stop its share of its first body within a frame.
bool is_sprung(dxJoint* joint);

/// Of what `body` hangs on, contacts left out: how many joints, and what the motors and stops of hinges (1
/// and 2), sliders, pistons, universal joints and pure motors are set to. Another number, never 0, where that
/// is another.
std::uint64_t sum_up_joints(dxBody* body);

enum class JointKind { ball, hinge };

/// Joins `first` to `second`, or to the world where that is null, as they are now, at `anchor` (m, world);
/// `axis` (unit, world) is a hinge's. The joint is the world's, which destroys it.
void join_bodies(dxBody* first, dxBody* second, JointKind kind, const Vec3& anchor,
                 const Vec3& axis = Vec3::UnitZ());

}  // namespace lodestone
