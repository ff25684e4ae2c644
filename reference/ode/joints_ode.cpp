#include "reference/ode/joints_ode.h"

#include <algorithm>
#include <cmath>

#include "reference/friction_across.h"
#include "reference/ode/bodies_ode.h"
#include "reference/ode/touches_ode.h"

namespace lodestone::ode {
namespace {

void copy(const Vec3& from, dReal* to) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

/// kg; of what nothing can push, infinite.
double mass_of(dBodyID body) {
  if (!body) return dInfinity;
  dMass mass;
  dBodyGetMass(body, &mass);
  return mass.mass;
}

/// m/s
Vec3 velocity_at(const ContactSide& side, const Vec3& point) {
  if (side.motion) return side.motion->velocity_at(point);
  if (!side.body) return Vec3::Zero();
  const Vec3 arm = point - to_vec3(dBodyGetPosition(side.body));
  return to_vec3(dBodyGetLinearVel(side.body)) + to_vec3(dBodyGetAngularVel(side.body)).cross(arm);
}

/// m, body axes; zero of what is no body.
Vec3 arm_on(const ContactSide& side, const Vec3& point) {
  const dBodyID body = side.body ? side.body : side.kinematic;
  if (!body) return Vec3::Zero();
  const RigidState state = state_of(body);
  return state.orientation.conjugate() * (point - state.position);
}

// QuickStep's iterations carry a blow through a body a twelfth as heavy no more as they should.
constexpr double kUnevenMasses = 12.0;

Vec3 tangential(const Vec3& v, const Vec3& normal) { return v - v.dot(normal) * normal; }

}  // namespace

ContactSide side_of(dBodyID body, MaterialId material, OdeBodyId id, dGeomID callers_geom) {
  if (!body || !dBodyIsKinematic(body)) return {body, material, id, {}, false, callers_geom};
  ContactSide side{nullptr, material, id, {}, is_moving(body), callers_geom};
  side.kinematic = body;
  const RigidState state = state_of(body);
  if (side.moves) side.motion = {state.position, state.velocity, state.angular_velocity};
  return side;
}

ContactJoints::ContactJoints(dWorldID world, const OdeSettings& settings, const MaterialTable& materials)
    : world_(world),
      group_(dJointGroupCreate(0)),
      materials_(&materials),
      slides_straight_(settings.friction_along_slip && settings.slides_straight),
      erp_(settings.erp),
      cfm_(settings.cfm),
      max_correcting_velocity_(settings.max_correcting_velocity),
      correcting_time_(settings.correcting_time) {
  mode_ = dContactBounce | dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  if (settings.friction_along_slip) mode_ |= dContactFDir1;
  if (slides_straight_) mode_ |= dContactMu2;
  joint_.surface.bounce_vel = settings.bounce_velocity;
}

ContactJoints::~ContactJoints() { dJointGroupDestroy(group_); }

void ContactJoints::begin(double h, int attempt, double surface_layer) {
  constexpr double kAddedCfm[kMostAttempts] = {0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5},
                   kUnevenness[kMostAttempts] = {1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1};
  dVector3 gravity;
  dWorldGetGravity(world_, gravity);
  gravity_ = to_vec3(gravity);
  contacts_.clear();
  carried_.clear();
  is_uneven_ = false;
  if (touches_) touches_->begin_substep();
  h_ = h;
  attempt_cfm_ = cfm_ + kAddedCfm[attempt];
  const double fall = gravity_.norm() * h * h;
  unevenness_ = kUnevenness[attempt] * fall;
  unpushed_ = surface_layer * fall;
  // ODE pushes overlap apart at erp × depth / h; capping the depth caps that speed for our contacts alone,
  // whosever the world is.
  const double erp = erp_ * (h < correcting_time_ ? h / correcting_time_ : 1.0);
  joint_.surface.soft_erp = erp;
  deepest_ = erp > 0.0 ? max_correcting_velocity_ * h / erp : dInfinity;
}

void ContactJoints::add(const ContactSide& first, const ContactSide& second,
                        std::span<const ContactPoint> points) {
  const ContactLaw pair = law(first.material, second.material);
  joint_.surface.mu = pair.friction;
  joint_.surface.bounce = pair.restitution;
  const auto [lighter, heavier] = std::minmax({mass_of(first.body), mass_of(second.body)});
  is_uneven_ |= first.body && second.body && heavier >= kUnevenMasses * lighter;
  joint_.surface.soft_cfm = attempt_cfm_ * cfm_share(lighter) * light_share(lighter);
  // Friction's is the world's, but for light bodies.
  joint_.surface.slip1 = joint_.surface.slip2 = light_share(lighter) > 1.0 ? joint_.surface.soft_cfm : 0.0;
  for (const auto& [side, other] : {std::pair(first, second), std::pair(second, first)}) {
    if (!side.body || !other.moves) continue;
    carried_.push_back(side.body);
    if (!dBodyIsEnabled(side.body)) dBodyEnable(side.body);
  }
  for (const ContactPoint& point : points) {
    add_joint(first, second, point);
    const double side = first.id ? 1.0 : -1.0;  // contacts() names this world's body first
    const ContactSide& other = first.id ? second : first;
    const ContactSide& own = first.id ? first : second;
    contacts_.push_back({own.id, other.id, point.point, side * point.normal, std::max(0.0, point.depth),
                         other.id ? Vec3(Vec3::Zero()) : velocity_at(other, point.point),
                         !other.id && other.moves, arm_on(own, point.point), arm_on(other, point.point),
                         other.callers_slot, point.above, other.material});
  }
  graph_.add(first.body, second.body, int(points.size()));
  made_ += std::int64_t(points.size());
}

void ContactJoints::add_joint(const ContactSide& first, const ContactSide& second,
                              const ContactPoint& point) {
  copy(point.point, joint_.geom.pos);
  copy(point.normal, joint_.geom.normal);
  joint_.geom.depth = first.body && second.body
                          ? depth_of(point)
                          : std::min(point.depth, deepest_ + first.way_on + second.way_on);
  joint_.geom.depth -= unpushed_;
  joint_.surface.mode = mode_;
  joint_.surface.motionN = point.lift;
  if (point.lift != 0.0) joint_.surface.mode |= dContactMotionN;
  if (joint_.surface.slip1 > 0.0) joint_.surface.mode |= dContactSlip1 | dContactSlip2;
  copy(slip_direction(first, second, point), joint_.fdir1);
  if (slides_straight_) joint_.surface.mu2 = joint_.surface.mu * share_across(first, second, point);
  for (const auto& [side, rider] : {std::pair(&first, &second), std::pair(&second, &first)})
    if (side->motion)
      move_surface(carrying_velocity(*side->motion, rider->body, point.point), point, side == &first);
  const dJointID joint = dJointCreateContact(world_, group_, &joint_);
  dJointAttach(joint, first.body, second.body);
  if (touches_) touches_->watch(joint, first, second, point, approach_of(first, second, point));
}

/// m/s along the normal, as they are now.
double ContactJoints::approach_of(const ContactSide& first, const ContactSide& second,
                                  const ContactPoint& point) const {
  return point.normal.dot(velocity_at(second, point.point) - velocity_at(first, point.point));
}

// Along the chord of a rider's arc, not along the tangent at its beginning, on which it would walk outward by
// ω² h² r / 2 in each step: what goes round with its carrier is turned by half of ω h on the way.
Vec3 ContactJoints::carrying_velocity(const SurfaceMotion& carrier, dBodyID rider, const Vec3& point) const {
  const Vec3& turning = carrier.angular_velocity;
  if (!rider || turning.isZero(0.0)) return carrier.velocity_at(point);
  const Vec3 going_round = to_vec3(dBodyGetLinearVel(rider)) - carrier.velocity;
  return carrier.velocity_at(point) + (rotation_from_vector(0.5 * h_ * turning) * going_round - going_round);
}

/// `turned`: the surface is the first side, ODE's first body the second.
void ContactJoints::move_surface(const Vec3& velocity, const ContactPoint& point, bool turned) {
  const Vec3 normal = turned ? Vec3(-point.normal) : point.normal, along = to_vec3(joint_.fdir1);
  joint_.surface.mode |= dContactFDir1 | dContactMotionN | dContactMotion1 | dContactMotion2;
  joint_.surface.motionN += normal.dot(velocity);
  joint_.surface.motion1 = along.dot(velocity);
  joint_.surface.motion2 = normal.cross(along).dot(velocity);
}

// ODE's solver gives up where two contacts tie exactly, as those of bodies at rest on each other do; a small
// part of what a body falls in a step sets them apart.
double ContactJoints::depth_of(const ContactPoint& point) const {
  const double turn = 0.6180339887498949 * double(contacts_.size());  // of the golden angle: no two alike
  return std::clamp(point.depth + unevenness_ * (turn - std::floor(turn)), 0.0, deepest_);
}

// ODE's friction is a box: μ along fdir1 and μ across it, so only along fdir1 is it Coulomb's. Friction
// opposes the slip that the step would have without it; taking that rather than the slip before it lets a
// body at rest on a slope start downhill.
Vec3 ContactJoints::slip_direction(const ContactSide& first, const ContactSide& second,
                                   const ContactPoint& point) const {
  const Vec3 relative = unhindered_velocity(first, point.point) - unhindered_velocity(second, point.point);
  const double still = 1e-3 * h_ * gravity_.norm() + 1e-9;
  for (const Vec3& direction : {relative, gravity_}) {
    const Vec3 slip = tangential(direction, point.normal);
    if (slip.squaredNorm() > still * still) return slip.normalized();
  }
  return point.normal.unitOrthogonal();
}

// For what a force or torque drives alone.
double ContactJoints::share_across(const ContactSide& first, const ContactSide& second,
                                   const ContactPoint& point) const {
  const auto is_pushed = [](dBodyID body) {
    return body && !(to_vec3(dBodyGetForce(body)).isZero(0.0) && to_vec3(dBodyGetTorque(body)).isZero(0.0));
  };
  if (!is_pushed(first.body) && !is_pushed(second.body)) return 1.0;
  const auto of_whole = [&](const ContactSide& side) {
    return side.body ? to_vec3(dBodyGetLinearVel(side.body)) : velocity_at(side, point.point);
  };
  return friction_share_across(
      tangential(velocity_at(first, point.point) - velocity_at(second, point.point), point.normal),
      tangential(of_whole(first) - of_whole(second), point.normal), joint_.surface.mu * gravity_.norm() * h_);
}

/// Of the body's material at `point` at the end of the step if nothing but gravity and applied forces acted
/// on it.
Vec3 ContactJoints::unhindered_velocity(const ContactSide& side, const Vec3& point) const {
  const Vec3 now = velocity_at(side, point);
  const dBodyID body = side.body;
  if (!body || !dBodyIsEnabled(body)) return now;
  dMass mass;
  dBodyGetMass(body, &mass);
  const Vec3 pull = dBodyGetGravityMode(body) ? gravity_ : Vec3::Zero();
  Vec3 gained = pull + to_vec3(dBodyGetForce(body)) / mass.mass;  // m/s²
  if (const Vec3 torque = to_vec3(dBodyGetTorque(body)); !torque.isZero(0.0)) {
    const RigidState state = state_of(body);
    const Mat3 inertia = Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(mass.I).leftCols<3>();
    const Vec3 in_body = state.orientation.conjugate() * torque;
    gained += (state.orientation * Vec3(inertia.ldlt().solve(in_body))).cross(point - state.position);
  }
  return now + h_ * gained;
}

}  // namespace lodestone::ode
