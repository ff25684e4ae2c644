#include "reference/ode/body_joints.h"

#include <ode/ode.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_set>

#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

Vec3 read(dJointID joint, void (*get)(dJointID, dVector3)) {
  dVector3 v;
  get(joint, v);
  return {v[0], v[1], v[2]};
}

Vec3 place_of(dxBody* body) {
  const dReal* p = dBodyGetPosition(body);
  return {p[0], p[1], p[2]};
}

// By a fixed joint, to the world or to what is kinematic.
bool is_anchored(dxBody* body) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    if (dJointGetType(joint) != dJointTypeFixed || !dJointIsEnabled(joint)) continue;
    const dBodyID first = dJointGetBody(joint, 0), other = first == body ? dJointGetBody(joint, 1) : first;
    if (!other || dBodyIsKinematic(other)) return true;
  }
  return false;
}

// Of the two; where one holds the other fast, and may be far away or small, of the one that is held.
Vec3 middle_of(dxBody* body, dxBody* second) {
  if (!second || holds_fast(second, body)) return place_of(body);
  return holds_fast(body, second) ? place_of(second) : Vec3(0.5 * (place_of(body) + place_of(second)));
}

// Where its only body is its second, ODE turns the axis of a slider and of a piston round, and what it says
// of a hinge's angle, but not the angle that its stops go by.
double sense_of(dJointID joint) { return dJointGetBody(joint, 0) ? 1.0 : -1.0; }

/// Of a slider or a piston.
struct Sliding {
  Vec3 direction;  ///< in which its position grows
  double position = 0.0;
  dReal (*parameter)(dJointID, int) = nullptr;
};

std::optional<Sliding> sliding_of(dJointID joint) {
  if (dJointGetType(joint) == dJointTypeSlider)
    return Sliding{sense_of(joint) * read(joint, dJointGetSliderAxis), dJointGetSliderPosition(joint),
                   dJointGetSliderParam};
  if (dJointGetType(joint) == dJointTypePiston)
    return Sliding{sense_of(joint) * read(joint, dJointGetPistonAxis), dJointGetPistonPosition(joint),
                   dJointGetPistonParam};
  return {};
}

/// Of a prismatic joint with a rotoide (PR) that has a first body; those that have only a second one go their
/// own ways in ODE.
std::optional<Sliding> pr_sliding_of(dJointID joint) {
  if (dJointGetType(joint) != dJointTypePR || !dJointGetBody(joint, 0)) return {};
  return Sliding{read(joint, dJointGetPRAxis1), dJointGetPRPosition(joint), dJointGetPRParam};
}

/// The axes of an LMotor that push: directions, speeds (m/s) and greatest forces (N).
struct PushedAxis {
  Vec3 direction;
  double speed = 0.0, force = 0.0;
};
std::vector<PushedAxis> pushed_axes(dJointID motor) {
  std::vector<PushedAxis> pushed;
  for (int i = 0; i < dJointGetLMotorNumAxes(motor); ++i) {
    const double force = dJointGetLMotorParam(motor, dParamFMax + i * dParamGroup2);
    if (!(force > 0.0)) continue;
    dVector3 axis;
    dJointGetLMotorAxis(motor, i, axis);
    pushed.push_back(
        {{axis[0], axis[1], axis[2]}, dJointGetLMotorParam(motor, dParamVel + i * dParamGroup2), force});
  }
  return pushed;
}

double hinge_angle(dJointID hinge) { return sense_of(hinge) * dJointGetHingeAngle(hinge); }

void hold(dxBody* second, const Vec3& point, std::vector<JointRow>& rows) {
  for (const Vec3& direction : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})
    rows.push_back({second, point, direction});
}

// Two points, `reach` m apart.
void hold_to_axis(dxBody* second, const Vec3& at, const Vec3& axis, double reach,
                  std::vector<JointRow>& rows) {
  const Vec3 across = axis.unitOrthogonal(), way = 0.5 * reach * axis;
  for (const Vec3& point : {Vec3(at + way), Vec3(at - way)})
    rows.push_back({second, point, across}), rows.push_back({second, point, axis.cross(across)});
}

// Of a wheel's joint: but for the way along which it is sprung.
void hold_wheel(dJointID joint, dxBody* second, std::vector<JointRow>& rows) {
  const Vec3 anchor = read(joint, dJointGetHinge2Anchor2);
  if (!is_sprung(joint)) return hold(second, anchor, rows);
  const Vec3 up = read(joint, dJointGetHinge2Axis1), across = up.unitOrthogonal();
  rows.push_back({second, anchor, across}), rows.push_back({second, anchor, up.cross(across)});
}

struct JointParameters {
  dReal (*read)(dJointID, int) = nullptr;
  int axes = 1;
};

JointParameters parameters_of(dJointType type) {
  switch (type) {
    case dJointTypeHinge:
      return {dJointGetHingeParam};
    case dJointTypeSlider:
      return {dJointGetSliderParam};
    case dJointTypePiston:
      return {dJointGetPistonParam};
    case dJointTypePR:
      return {dJointGetPRParam, 2};
    case dJointTypePU:
      return {dJointGetPUParam, 3};
    case dJointTypeHinge2:
      return {dJointGetHinge2Param, 2};
    case dJointTypeUniversal:
      return {dJointGetUniversalParam, 2};
    case dJointTypeAMotor:
      return {dJointGetAMotorParam, 3};
    case dJointTypeLMotor:
      return {dJointGetLMotorParam, 3};
    default:
      return {};
  }
}

}  // namespace

bool holds_fast(dxBody* holder, dxBody* body) {
  if (dBodyIsKinematic(holder)) return !dBodyIsKinematic(body);
  return is_anchored(holder) && !is_anchored(body) && !dBodyIsKinematic(body);
}

std::uint64_t sum_up_joints(dxBody* body) {
  std::uint64_t sum = 1;
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    const dJointType type = dJointGetType(joint);
    if (type == dJointTypeContact) continue;
    std::uint64_t own = std::uint64_t(type) * 2 + std::uint64_t(dJointIsEnabled(joint));
    const JointParameters parameters = parameters_of(type);
    for (int axis = 0; parameters.read && axis < parameters.axes; ++axis) {
      std::array<double, 4> settings{};
      const std::array<int, 4> names{dParamVel, dParamFMax, dParamLoStop, dParamHiStop};
      for (std::size_t k = 0; k < names.size(); ++k)
        settings[k] = parameters.read(joint, names[k] + axis * dParamGroup2);
      own = XXH64(settings.data(), sizeof settings, own);
    }
    sum += 2 * own;  // in any order, and never 0
  }
  return sum;
}

void find_joint_rows(dxBody* body, double reach, std::vector<JointRow>& rows) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    if (!dJointIsEnabled(joint)) continue;
    const dBodyID first = dJointGetBody(joint, 0), other = dJointGetBody(joint, 1);
    if (first && first != body) continue;
    const dBodyID second = first ? other : nullptr;
    switch (dJointGetType(joint)) {
      case dJointTypeBall:
        hold(second, read(joint, dJointGetBallAnchor), rows);
        break;
      case dJointTypeUniversal:
        hold(second, read(joint, dJointGetUniversalAnchor), rows);
        break;
      case dJointTypeHinge2:
        hold_wheel(joint, second, rows);
        break;
      case dJointTypeHinge: {
        const Vec3 anchor = read(joint, dJointGetHingeAnchor),
                   way = 0.5 * reach * read(joint, dJointGetHingeAxis);
        hold(second, anchor + way, rows), hold(second, anchor - way, rows);
        break;
      }
      case dJointTypeFixed: {
        const Vec3 middle = middle_of(body, second);
        hold(second, middle, rows);
        hold(second, middle + reach * Vec3::UnitX(), rows),
            hold(second, middle + reach * Vec3::UnitY(), rows);
        break;
      }
      case dJointTypeSlider: {
        const Vec3 axis = read(joint, dJointGetSliderAxis), across = axis.unitOrthogonal(),
                   at = place_of(second && holds_fast(body, second) ? second : body);
        hold_to_axis(second, at, axis, reach, rows);
        rows.push_back({second, at + reach * across, axis.cross(across)});
        break;
      }
      case dJointTypePR: {
        const std::optional<Sliding> slides = pr_sliding_of(joint);
        if (!slides) break;
        const Vec3 anchor = read(joint, dJointGetPRAnchor), along = slides->direction,
                   about = read(joint, dJointGetPRAxis2), across = along.cross(about).normalized();
        for (const double side : {0.5, -0.5}) rows.push_back({second, anchor + side * reach * about, across});
        for (const double side : {0.5, -0.5}) rows.push_back({second, anchor + side * reach * along, about});
        break;
      }
      case dJointTypePiston: {
        hold_to_axis(second, read(joint, dJointGetPistonAnchor), read(joint, dJointGetPistonAxis), reach,
                     rows);
        break;
      }
      default:
        break;
    }
  }
}

void find_joint_stops(dxBody* body, double reach, std::vector<JointStop>& stops) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    if (!dJointIsEnabled(joint) || !has_hard_stops(joint)) continue;
    const dBodyID first = dJointGetBody(joint, 0), other = dJointGetBody(joint, 1);
    if (first && first != body) continue;
    const dBodyID second = first ? other : nullptr;
    const std::optional<Sliding> slides = sliding_of(joint);
    const auto parameter = slides ? slides->parameter : dJointGetHingeParam;
    const double at = slides ? slides->position : hinge_angle(joint),
                 above = at - parameter(joint, dParamLoStop), below = parameter(joint, dParamHiStop) - at;
    if (above + below < 0.0) continue;  // ODE leaves out stops that are the wrong way round
    const Vec3 axis = slides ? slides->direction : read(joint, dJointGetHingeAxis),
               across = slides ? Vec3::Zero() : axis.unitOrthogonal(),
               point = slides ? middle_of(body, second)
                              : Vec3(read(joint, dJointGetHingeAnchor) + reach * across),
               way = slides ? axis : Vec3(axis.cross(across));
    const double lever = slides ? 1.0 : reach;  // m a m, or a rad
    if (lever * above < reach) stops.push_back({second, point, way, lever * above});
    if (lever * below < reach) stops.push_back({second, point, -way, lever * below});
  }
}

bool has_hard_stops(dxJoint* joint) {
  const dJointType type = dJointGetType(joint);
  const bool slides = type == dJointTypeSlider || type == dJointTypePiston;
  if (!slides && type != dJointTypeHinge) return false;
  const dBodyID first = dJointGetBody(joint, 0), body = first ? first : dJointGetBody(joint, 1);
  const auto parameter = parameters_of(type).read;
  return body && parameter(joint, dParamStopCFM) <= dWorldGetCFM(dBodyGetWorld(body));
}

void find_joint_motors(dxBody* body, double reach, std::vector<JointMotor>& motors) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
    const dJointID joint = dBodyGetJoint(body, i);
    if (!has_motor(joint)) continue;
    const dBodyID first = dJointGetBody(joint, 0), other = dJointGetBody(joint, 1);
    if (first && first != body) continue;
    const dBodyID second = first ? other : nullptr;
    if (dJointGetType(joint) == dJointTypeLMotor) {
      for (const PushedAxis& axis : pushed_axes(joint))
        motors.push_back({second, middle_of(body, second), axis.direction, axis.speed, axis.force});
      continue;
    }
    std::optional<Sliding> slides = sliding_of(joint);
    if (!slides) slides = pr_sliding_of(joint);
    if (slides) {
      motors.push_back({second, middle_of(body, second), slides->direction,
                        slides->parameter(joint, dParamVel), slides->parameter(joint, dParamFMax)});
      continue;
    }
    const auto add = [&](const Vec3& anchor, const Vec3& axis, double speed, double torque) {
      const Vec3 across = axis.unitOrthogonal();
      motors.push_back({second, anchor + reach * across, axis.cross(across), speed * reach, torque / reach});
    };
    if (dJointGetType(joint) == dJointTypeHinge2)
      add(read(joint, dJointGetHinge2Anchor2), read(joint, dJointGetHinge2Axis2),
          dJointGetHinge2Param(joint, dParamVel2), dJointGetHinge2Param(joint, dParamFMax2));
    else
      add(read(joint, dJointGetHingeAnchor), read(joint, dJointGetHingeAxis),
          dJointGetHingeParam(joint, dParamVel), dJointGetHingeParam(joint, dParamFMax));
  }
}

bool has_motor(dxJoint* joint) {
  const auto pushes = [&](const auto& parameter, double at) {
    return parameter(joint, dParamFMax) > 0.0 &&
           (has_hard_stops(joint) ||
            (at > parameter(joint, dParamLoStop) && at < parameter(joint, dParamHiStop)));
  };
  if (!dJointIsEnabled(joint)) return false;
  if (dJointGetType(joint) == dJointTypeLMotor) return !pushed_axes(joint).empty();
  for (const std::optional<Sliding>& slides : {sliding_of(joint), pr_sliding_of(joint)})
    if (slides) return pushes(slides->parameter, slides->position);
  if (dJointGetType(joint) == dJointTypeHinge2)  // on a spring it would drive the wheel too slowly
    return !is_sprung(joint) && dJointGetHinge2Param(joint, dParamFMax2) > 0.0;
  return dJointGetType(joint) == dJointTypeHinge && pushes(dJointGetHingeParam, hinge_angle(joint));
}

bool is_driven(dxJoint* joint) {
  const JointParameters parameters = parameters_of(dJointGetType(joint));
  if (!parameters.read || !dJointIsEnabled(joint)) return false;
  for (int axis = 0; axis < parameters.axes; ++axis)
    if (parameters.read(joint, dParamFMax + axis * dParamGroup2) > 0.0 &&
        parameters.read(joint, dParamVel + axis * dParamGroup2) != 0.0)
      return true;
  return false;
}

// ODE's constraint is a spring of ERP / (h CFM) N/m and a damper of (1 − ERP) / CFM N s/m in a substep of h
// s.
bool is_sprung(dxJoint* joint) {
  constexpr double kFrame = 1.0 / 60.0, kSubstep = kFrame / 4.0;  // s, as usual
  constexpr double kStiff = 3.0;
  const dBodyID first = dJointGetBody(joint, 0), body = first ? first : dJointGetBody(joint, 1);
  if (dJointGetType(joint) != dJointTypeHinge2 || !body) return false;
  const double erp = dJointGetHinge2Param(joint, dParamSuspensionERP),
               cfm = dJointGetHinge2Param(joint, dParamSuspensionCFM);
  if (cfm <= dWorldGetCFM(dBodyGetWorld(body))) return false;
  const double share = callers::mass(body) / double(joined_bodies(body).size()),  // kg
      in_frame = (erp / kSubstep * kFrame + 1.0 - erp) / cfm * kFrame;            // kg
  return in_frame < kStiff * share;
}

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

std::vector<dxBody*> find_jointed_group(dxBody* body) {
  std::vector<dxBody*> group{body};
  if (!has_joints(body)) return group;
  std::unordered_set<dxBody*> known{body};
  for (std::size_t i = 0; i < group.size(); ++i)
    for (dxBody* const other : joined_bodies(group[i]))
      if (other && !dBodyIsKinematic(other) && known.insert(other).second) group.push_back(other);
  return group;
}

bool are_joined(dxBody* first, dxBody* second) {
  return dAreConnectedExcluding(first, second, dJointTypeContact) != 0;
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
