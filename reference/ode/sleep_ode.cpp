#include "reference/ode/sleep_ode.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/ode/body_joints.h"
#include "reference/rocking.h"

namespace lodestone::ode {
namespace {

constexpr double kDrawn = 0.2;     // of the law's time: for so long who was drawn along stays awake
constexpr double kWithheld = 0.8;  // of the law's speed: who is given more than that anew wakes,
constexpr double kForgets = 0.1;   // s, within about this time

double square(double x) { return x * x; }

// Summed as ODE does.
double squared_norm(const dReal* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

// ODE would keep what acts on it until it wakes, and then give it at once: that is right for what holds it
// up.
void put_to_rest(const Body& body) {
  dBodyDisable(body.body);
  set_force(body.body, body.held_force, body.held_torque);
  dBodySetLinearVel(body.body, 0, 0, 0);
  dBodySetAngularVel(body.body, 0, 0, 0);
}

}  // namespace

void Sleep::run(Bodies& bodies, std::span<const dBodyID> carried, const Vec3& gravity, double h) {
  gravity_ = gravity;
  if (on_) find_carried(bodies, carried), find_pulled(bodies);
  const double strength = gravity.norm();
  for (Body& body : bodies.slots()) {
    const bool was_put_to_rest = std::exchange(body.fell_asleep, false);
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    // Woken from outside, and not by ODE's own step with those that it hangs together with.
    if (!body.was_enabled || body.disturbed) body.to_sleep_s = law_.time;
    body.was_enabled = true;
    body.disturbed = false;
    if (!on_ || dBodyGetNumJoints(body.body) == 0 || !body.properties.allow_sleep ||
        body.properties.kinematic)
      continue;
    body.to_sleep_s =
        is_still(body) ? body.to_sleep_s - h / rocking_slowness(body.reach, strength) : law_.time;
    if (body.to_sleep_s <= 0.0 && is_drawn(bodies, body)) body.to_sleep_s = kDrawn * law_.time;
    if (body.to_sleep_s > 0.0) continue;
    if (was_put_to_rest && is_dragged(body, h)) {
      body.to_sleep_s = law_.time;
      continue;
    }
    if (!was_put_to_rest) body.withheld = Vec3::Zero();
    body.fell_asleep = true;
    put_to_rest(body);
  }
}

bool Sleep::is_still(const Body& body) const {
  if (carried_.contains(body.body)) return false;
  const double share = falling_speed_share(gravity_.norm());
  return squared_norm(dBodyGetLinearVel(body.body)) <= square(share * law_.speed) &&
         squared_norm(dBodyGetAngularVel(body.body)) <= square(share * law_.turning_speed / body.reach);
}

namespace {

constexpr double kGivesWay = 0.02;  // times the law's speed

Vec3 velocity_at(dBodyID body, const Vec3& point) {
  const Vec3 velocity = to_vec3(dBodyGetLinearVel(body)), turning = to_vec3(dBodyGetAngularVel(body)),
             arm = point - to_vec3(dBodyGetPosition(body));
  return velocity + turning.cross(arm);
}

double speed_at(dBodyID body, const Vec3& point) { return velocity_at(body, point).norm(); }

// To a force or torque on it, other than what holds it up; seen from `point`.
bool gives_way(Bodies& bodies, dBodyID body, const Vec3& point, double slow) {
  const Vec3 velocity = to_vec3(dBodyGetLinearVel(body)), turning = to_vec3(dBodyGetAngularVel(body));
  Vec3 force = to_vec3(dBodyGetForce(body)), torque = to_vec3(dBodyGetTorque(body));
  if (const Body* own = bodies.owner(body); own && is_held(*own))
    force -= own->held_force, torque -= own->held_torque;
  const double arm = (point - to_vec3(dBodyGetPosition(body))).norm();
  return velocity.dot(force) > slow * force.norm() || turning.dot(torque) * arm > slow * torque.norm();
}

// Whether one that hangs together with `joined` by joints does, or is driven by a motor. Adds these, as far
// as it looks.
bool is_pulled_together(Bodies& bodies, std::vector<dBodyID>& joined, const Vec3& point, double slow) {
  for (std::size_t next = 0; next < joined.size(); ++next) {
    if (gives_way(bodies, joined[next], point, slow)) return true;
    for (int i = 0; i < dBodyGetNumJoints(joined[next]); ++i) {
      const dJointID joint = dBodyGetJoint(joined[next], i);
      if (dJointGetType(joint) == dJointTypeContact) continue;
      if (is_driven(joint)) return true;
      for (const int end : {0, 1})
        if (const dBodyID by = dJointGetBody(joint, end); by && !std::ranges::count(joined, by))
          joined.push_back(by);
    }
  }
  return false;
}

// To a force, a motor, or to what pulls it by joints.
bool is_pulled(Bodies& bodies, dBodyID body, const Vec3& point, double slow) {
  if (gives_way(bodies, body, point, slow)) return true;
  if (speed_at(body, point) < slow) return false;
  std::vector<dBodyID> joined{body};
  return is_pulled_together(bodies, joined, point, slow);
}

bool has_own_joints(dBodyID body) {
  for (int i = 0; i < dBodyGetNumJoints(body); ++i)
    if (dJointGetType(dBodyGetJoint(body, i)) != dJointTypeContact) return true;
  return false;
}

// By a joint, on what nothing stops.
bool hangs_on_mover(dBodyID body) {
  return std::ranges::any_of(joined_bodies(body), [](dBodyID other) {
    return other && dBodyIsKinematic(other) && is_moving(other);
  });
}

Vec3 rim_of(const Body& body) {
  const Vec3 turning = to_vec3(dBodyGetAngularVel(body.body)), center = to_vec3(dBodyGetPosition(body.body));
  return turning.isZero(0.0) ? center : Vec3(center + body.reach * turning.unitOrthogonal());
}

}  // namespace

// Of one that was put to rest in the last substep, too: whether one that it touches, faster than what sleeps,
// moves it its own way time and again, and is held back by it.
bool Sleep::is_dragged(Body& body, double h) const {
  body.withheld = std::exp(-h / kForgets) * body.withheld + to_vec3(dBodyGetLinearVel(body.body));
  if (body.withheld.squaredNorm() <= square(kWithheld * law_.speed)) return false;
  const Vec3 center = to_vec3(dBodyGetPosition(body.body));
  const auto drags = [&](dBodyID other) {
    if (!other || other == body.body || !dBodyIsEnabled(other)) return false;
    const Vec3 velocity = velocity_at(other, center);
    const double speed = velocity.norm();
    return speed > law_.speed && body.withheld.dot(velocity) > kWithheld * law_.speed * speed;
  };
  for (int i = 0; i < dBodyGetNumJoints(body.body); ++i) {
    const dJointID joint = dBodyGetJoint(body.body, i);
    if (drags(dJointGetBody(joint, 0)) || drags(dJointGetBody(joint, 1))) return true;
  }
  return false;
}

// Whether what it touches moves, or gives way to a force or a motor: put to rest again in each step, it would
// hold that back, and of what the two exchange its share be lost. (What jitters in a heap moves nobody.)
bool Sleep::is_drawn(Bodies& bodies, const Body& body) const {
  constexpr double kMoves = 4.0;  // times the speed
  if (pulled_.contains(body.body)) return true;
  const Vec3 center = to_vec3(dBodyGetPosition(body.body));
  const auto draws = [&](dBodyID other) {
    if (!other || other == body.body || !dBodyIsEnabled(other)) return false;
    return speed_at(other, center) > kMoves * law_.speed ||
           is_pulled(bodies, other, center, kGivesWay * law_.speed);
  };
  for (int i = 0; i < dBodyGetNumJoints(body.body); ++i) {
    const dJointID joint = dBodyGetJoint(body.body, i);
    if (draws(dJointGetBody(joint, 0)) || draws(dJointGetBody(joint, 1))) return true;
  }
  return false;
}

// And who lies on them, on those in turn, and so on. What hangs together by joints is looked through once.
void Sleep::find_pulled(Bodies& bodies) {
  const double slow = kGivesWay * law_.speed;
  pulled_.clear(), unpulled_.clear(), waiting_.clear();
  const auto add = [&](dBodyID body) {
    if (pulled_.insert(body).second) waiting_.push_back(body);
  };
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body) || body.properties.kinematic) continue;
    const Vec3 rim = rim_of(body);
    if (!has_own_joints(body.body)) {
      if (gives_way(bodies, body.body, rim, slow)) add(body.body);
    } else if (!unpulled_.contains(body.body)) {
      joined_.assign(1, body.body);
      if (!is_pulled_together(bodies, joined_, rim, slow)) {
        unpulled_.insert(joined_.begin(), joined_.end());
        continue;
      }
      if (speed_at(body.body, rim) >= slow) add(body.body);
    }
  }
  if (waiting_.empty()) return;
  const auto height = [&](dBodyID body) { return -gravity_.dot(to_vec3(dBodyGetPosition(body))); };
  while (!waiting_.empty()) {
    const dBodyID body = waiting_.back();
    waiting_.pop_back();
    for (int i = 0; i < dBodyGetNumJoints(body); ++i) {
      const dJointID joint = dBodyGetJoint(body, i);
      if (dJointGetType(joint) != dJointTypeContact) continue;
      for (const int end : {0, 1})
        if (const dBodyID other = dJointGetBody(joint, end);
            other && other != body && dBodyIsEnabled(other) && height(other) > height(body) &&
            pulled_.insert(other).second)
          waiting_.push_back(other);
    }
  }
}

void Sleep::find_carried(Bodies& bodies, std::span<const dBodyID> carried) {
  carried_.clear();
  waiting_.assign(carried.begin(), carried.end());
  for (const Body& body : bodies.slots())
    if (body.body && body.kept_awake) waiting_.push_back(body.body);
  grouped_.clear();
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body) || !has_own_joints(body.body) ||
        grouped_.contains(body.body))
      continue;
    joined_ = find_jointed_group(body.body);
    grouped_.insert(joined_.begin(), joined_.end());
    if (std::ranges::any_of(joined_, hangs_on_mover)) waiting_.push_back(body.body);
  }
  while (!waiting_.empty()) {
    const dBodyID body = waiting_.back();
    waiting_.pop_back();
    if (dBodyIsKinematic(body) || !carried_.insert(body).second) continue;
    for (int i = 0; i < dBodyGetNumJoints(body); ++i)
      for (const int end : {0, 1})
        if (const dBodyID other = dJointGetBody(dBodyGetJoint(body, i), end)) waiting_.push_back(other);
  }
}

}  // namespace lodestone::ode
