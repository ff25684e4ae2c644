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

void Sleep::run(Bodies& bodies, const ContactJoints& joints, double h) {
  const ContactGraph& contacts = joints.graph();
  gravity_ = joints.gravity();
  if (on_) find_carried(bodies, joints), find_pulled(bodies, contacts);
  const double strength = gravity_.norm();
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
    if (body.to_sleep_s <= 0.0 && is_drawn(bodies, body, contacts)) body.to_sleep_s = kDrawn * law_.time;
    if (body.to_sleep_s > 0.0) continue;
    if (was_put_to_rest && is_dragged(body, contacts, h)) {
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

bool is_contact(dJointID joint) { return dJointGetType(joint) == dJointTypeContact; }

template <class Predicate>
bool any_end(dJointID joint, dBodyID body, const Predicate& predicate) {
  const auto is_one = [&](dBodyID other) { return other && other != body && predicate(other); };
  return is_one(dJointGetBody(joint, 0)) || is_one(dJointGetBody(joint, 1));
}

// Whether the predicate holds for any that a joint ties to `body`.
template <class Predicate>
bool any_tied(const ContactGraph& contacts, dBodyID body, const Predicate& predicate) {
  return contacts.any_other_joint(
      body, [&](dJointID joint) { return !is_contact(joint) && any_end(joint, body, predicate); });
}

// For any that it touches, by contacts of the caller's own, too.
template <class Predicate>
bool any_touched(const ContactGraph& contacts, dBodyID body, const Predicate& predicate) {
  return std::ranges::any_of(contacts.met_by(body), predicate) ||
         contacts.any_other_joint(
             body, [&](dJointID joint) { return is_contact(joint) && any_end(joint, body, predicate); });
}

// Whether one that hangs together with `joined` by joints does, or is driven by a motor. Adds these, as far
// as it looks.
bool is_pulled_together(Bodies& bodies, const ContactGraph& contacts, std::vector<dBodyID>& joined,
                        const Vec3& point, double slow) {
  const auto drives = [&](dJointID joint) {
    if (is_contact(joint)) return false;
    if (is_driven(joint)) return true;
    for (const int end : {0, 1})
      if (const dBodyID by = dJointGetBody(joint, end); by && !std::ranges::count(joined, by))
        joined.push_back(by);
    return false;
  };
  for (std::size_t next = 0; next < joined.size(); ++next)
    if (gives_way(bodies, joined[next], point, slow) || contacts.any_other_joint(joined[next], drives))
      return true;
  return false;
}

// To a force, a motor, or to what pulls it by joints.
bool is_pulled(Bodies& bodies, const ContactGraph& contacts, dBodyID body, const Vec3& point, double slow) {
  if (gives_way(bodies, body, point, slow)) return true;
  if (speed_at(body, point) < slow) return false;
  std::vector<dBodyID> joined{body};
  return is_pulled_together(bodies, contacts, joined, point, slow);
}

bool has_own_joints(dBodyID body, const ContactGraph& contacts) {
  return contacts.any_other_joint(body, [](dJointID joint) { return !is_contact(joint); });
}

Vec3 rim_of(const Body& body) {
  const Vec3 turning = to_vec3(dBodyGetAngularVel(body.body)), center = to_vec3(dBodyGetPosition(body.body));
  return turning.isZero(0.0) ? center : Vec3(center + body.reach * turning.unitOrthogonal());
}

}  // namespace

// Of one that was put to rest in the last substep, too: whether one that it touches, faster than what sleeps,
// moves it its own way time and again, and is held back by it.
bool Sleep::is_dragged(Body& body, const ContactGraph& contacts, double h) const {
  body.withheld = std::exp(-h / kForgets) * body.withheld + to_vec3(dBodyGetLinearVel(body.body));
  if (body.withheld.squaredNorm() <= square(kWithheld * law_.speed)) return false;
  const Vec3 center = to_vec3(dBodyGetPosition(body.body));
  const auto drags = [&](dBodyID other) {
    if (!dBodyIsEnabled(other)) return false;
    const Vec3 velocity = velocity_at(other, center);
    const double speed = velocity.norm();
    return speed > law_.speed && body.withheld.dot(velocity) > kWithheld * law_.speed * speed;
  };
  return any_touched(contacts, body.body, drags) || any_tied(contacts, body.body, drags);
}

// Whether what it touches moves, or gives way to a force or a motor: put to rest again in each step, it would
// hold that back, and of what the two exchange its share be lost. (What jitters in a heap moves nobody.)
bool Sleep::is_drawn(Bodies& bodies, const Body& body, const ContactGraph& contacts) const {
  constexpr double kMoves = 4.0;  // times the speed
  if (pulled_.contains(body.body)) return true;
  const Vec3 center = to_vec3(dBodyGetPosition(body.body));
  const auto draws = [&](dBodyID other) {
    return dBodyIsEnabled(other) && (speed_at(other, center) > kMoves * law_.speed ||
                                     is_pulled(bodies, contacts, other, center, kGivesWay * law_.speed));
  };
  return any_touched(contacts, body.body, draws) || any_tied(contacts, body.body, draws);
}

// And who lies on them, on those in turn, and so on. What hangs together by joints is looked through once.
void Sleep::find_pulled(Bodies& bodies, const ContactGraph& contacts) {
  const double slow = kGivesWay * law_.speed;
  pulled_.clear(), unpulled_.clear(), waiting_.clear();
  const auto add = [&](dBodyID body) {
    if (pulled_.insert(body).second) waiting_.push_back(body);
  };
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body) || body.properties.kinematic) continue;
    const Vec3 rim = rim_of(body);
    if (!has_own_joints(body.body, contacts)) {
      if (gives_way(bodies, body.body, rim, slow)) add(body.body);
    } else if (!unpulled_.contains(body.body)) {
      joined_.assign(1, body.body);
      if (!is_pulled_together(bodies, contacts, joined_, rim, slow)) {
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
    any_touched(contacts, body, [&](dBodyID other) {
      if (dBodyIsEnabled(other) && height(other) > height(body)) add(other);
      return false;
    });
  }
}

void Sleep::find_carried(Bodies& bodies, const ContactJoints& joints) {
  const ContactGraph& contacts = joints.graph();
  carried_.clear();
  waiting_.assign(joints.carried().begin(), joints.carried().end());
  for (const Body& body : bodies.slots())
    if (body.body && body.kept_awake) waiting_.push_back(body.body);
  grouped_.clear();
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body) || !has_own_joints(body.body, contacts) ||
        grouped_.contains(body.body))
      continue;
    find_group(body.body, contacts);
    const auto hangs_on_mover = [&](dBodyID member) {  // by a joint, on what nothing stops
      return any_tied(contacts, member, [](dBodyID by) { return dBodyIsKinematic(by) && is_moving(by); });
    };
    if (std::ranges::any_of(joined_, hangs_on_mover)) waiting_.push_back(body.body);
  }
  const auto add = [&](dBodyID other) {
    waiting_.push_back(other);
    return false;
  };
  while (!waiting_.empty()) {
    const dBodyID body = waiting_.back();
    waiting_.pop_back();
    if (dBodyIsKinematic(body) || !carried_.insert(body).second) continue;
    any_touched(contacts, body, add), any_tied(contacts, body, add);
  }
}

// All that hang together with it by joints, through any but kinematic bodies.
void Sleep::find_group(dBodyID body, const ContactGraph& contacts) {
  joined_.assign(1, body);
  grouped_.insert(body);
  for (std::size_t i = 0; i < joined_.size(); ++i)
    any_tied(contacts, joined_[i], [&](dBodyID other) {
      if (!dBodyIsKinematic(other) && grouped_.insert(other).second) joined_.push_back(other);
      return false;
    });
}

}  // namespace lodestone::ode
