#include "reference/ode/sleep_ode.h"

namespace lodestone::ode {
namespace {

double square(double x) { return x * x; }

// Summed as ODE does.
double squared_norm(const dReal* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

// ODE would keep what acts on it until it wakes, and then give it at once.
void put_to_rest(dBodyID body) {
  dBodyDisable(body);
  dBodySetForce(body, 0, 0, 0);
  dBodySetTorque(body, 0, 0, 0);
  dBodySetLinearVel(body, 0, 0, 0);
  dBodySetAngularVel(body, 0, 0, 0);
}

}  // namespace

void Sleep::run(Bodies& bodies, std::span<const dBodyID> carried, double h) {
  if (on_) find_carried(bodies, carried);
  for (Body& body : bodies.slots()) {
    body.fell_asleep = false;
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    // Woken from outside, and not by ODE's own step with those that it hangs together with.
    if (!body.was_enabled || body.disturbed) body.to_sleep_s = law_.time;
    body.was_enabled = true;
    body.disturbed = false;
    if (!on_ || dBodyGetNumJoints(body.body) == 0 || !body.properties.allow_sleep ||
        body.properties.kinematic)
      continue;
    body.to_sleep_s = is_still(body) ? body.to_sleep_s - h : law_.time;
    body.fell_asleep = body.to_sleep_s <= 0.0;
    if (body.fell_asleep) put_to_rest(body.body);
  }
}

bool Sleep::is_still(const Body& body) const {
  if (carried_.contains(body.body)) return false;
  return squared_norm(dBodyGetLinearVel(body.body)) <= square(law_.speed) &&
         squared_norm(dBodyGetAngularVel(body.body)) <= square(law_.turning_speed / body.reach);
}

void Sleep::find_carried(Bodies& bodies, std::span<const dBodyID> carried) {
  carried_.clear();
  waiting_.assign(carried.begin(), carried.end());
  for (const Body& body : bodies.slots())
    if (body.body && body.kept_awake) waiting_.push_back(body.body);
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
