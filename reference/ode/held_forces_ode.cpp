#include "reference/ode/held_forces_ode.h"

#include <algorithm>
#include <unordered_set>

namespace lodestone::ode {

void HeldForces::note(dWorldID world, Bodies& bodies, const SpaceMirror* mirror) {
  held_.clear(), jointed_.clear(), callers_.clear();
  const auto note_of_world = [&](dBodyID body) {
    if (dBodyGetWorld(body) == world) note_callers(body);
  };
  for (const Body& body : bodies.slots())
    if (body.body) note(body.body);
  if (mirror)
    for (const std::uint32_t slot : mirror->bodied()) note_of_world(mirror->geoms()[slot].body);
  for (const dBodyID body : included_) note_of_world(body);
  note_jointed(bodies);
  std::ranges::sort(callers_);
  callers_.erase(std::unique(callers_.begin(), callers_.end()), callers_.end());
}

void HeldForces::note_callers(dBodyID body) {
  callers_.push_back(body);
  note(body);
}

void HeldForces::note(dBodyID body) {
  const Vec3 force = to_vec3(dBodyGetForce(body)), torque = to_vec3(dBodyGetTorque(body));
  if (!force.isZero(0.0) || !torque.isZero(0.0)) held_.push_back({body, force, torque});
  if (dBodyGetNumJoints(body) > 0) jointed_.push_back(body);
}

// A body may be met twice: it then has the same force set twice.
void HeldForces::note_jointed(Bodies& bodies) {
  std::unordered_set<dBodyID> met(jointed_.begin(), jointed_.end());
  while (!jointed_.empty()) {
    const dBodyID body = jointed_.back();
    jointed_.pop_back();
    for (int i = 0; i < dBodyGetNumJoints(body); ++i)
      for (const int end : {0, 1})
        if (const dBodyID other = dJointGetBody(dBodyGetJoint(body, i), end);
            other && met.insert(other).second)
          bodies.owner(other) ? note(other) : note_callers(other);
  }
}

void HeldForces::note_states() {
  before_.clear();
  for (const dBodyID body : callers_)
    if (const RigidState state = state_of(body); is_sound(state))
      before_.push_back({body, state, dBodyIsEnabled(body) != 0});
}

void HeldForces::take_back() const {
  for (const auto& [body, state, enabled] : before_) {
    ode::set_state(body, state);
    if (enabled != (dBodyIsEnabled(body) != 0)) enabled ? dBodyEnable(body) : dBodyDisable(body);
  }
}

void HeldForces::give() const {
  for (const auto& [body, force, torque] : held_) {
    dBodySetForce(body, force.x(), force.y(), force.z());
    dBodySetTorque(body, torque.x(), torque.y(), torque.z());
  }
}

}  // namespace lodestone::ode
