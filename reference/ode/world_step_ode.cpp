#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "reference/ode/body_joints.h"
#include "reference/ode/islands.h"
#include "reference/ode/world_ode.h"
#include "reference/simulation_error.h"

namespace lodestone {

using namespace ode;

namespace {

// QuickStep's iterations carry a weight through a body a hundredth of it no more.
constexpr double kUneven = 100.0;

// Adds the time that it lives to a sum.
class Timing {
 public:
  explicit Timing(double& sum_ms) : sum_ms_(sum_ms) {}
  ~Timing() {
    sum_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  Timing(const Timing&) = delete;
  Timing& operator=(const Timing&) = delete;

 private:
  double& sum_ms_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

OdeWorld::Impl::Impl(dWorldID callers_world, dSpaceID callers_space, const OdeSettings& s,
                     const MaterialTable& materials)
    : settings(s),
      mirror(callers_space ? std::make_unique<SpaceMirror>(callers_space) : nullptr),
      own_world(callers_world ? nullptr : dWorldCreate()),
      world(callers_world ? callers_world : own_world),
      joints(world, s, materials),
      collision(mirror.get(), trimeshes, s),
      sleep(s),
      bodies(collision.broad_phase().bodies_space()) {
  if (own_world) set_up_own_world();
}

OdeWorld::Impl::~Impl() {
  // Bodies, geoms and joints go before the world that holds them.
  joints.end();
  bodies.clear();
  threading.reset();
  if (own_world) dWorldDestroy(own_world);
}

void OdeWorld::Impl::set_up_own_world() {
  threading = std::make_unique<StepThreading>(world);
  dWorldSetGravity(world, settings.gravity.x(), settings.gravity.y(), settings.gravity.z());
  dWorldSetQuickStepNumIterations(world, settings.quick_step_iterations);
  if (settings.cfm > 0.0)
    dWorldSetCFM(world, settings.cfm);  // friction's; without any its rows may come to depend on each other
}

// Nothing moves where all sleep, save in a caller's world, whose other bodies are unknown.
bool OdeWorld::Impl::has_work() {
  return !own_world || std::ranges::any_of(bodies.slots(), [](const Body& body) {
    return body.body && dBodyIsEnabled(body.body);
  });
}

void OdeWorld::Impl::look_at_callers_space() {
  put_back_unsound();
  wake_whose_joints_changed();
  if (!mirror) return;
  mirror->refresh();
  collision.note_changes(bodies);
  for (const Eigen::AlignedBox3d& box : vacated) collision.broad_phase().wake_callers(box);
  vacated.clear();
  has_looked = true;
}

void OdeWorld::Impl::begin_step(double h) {
  if (!failure.empty()) throw SimulationError(failure, failed_over);
  if (!has_looked) look_at_callers_space();
  times = {};
  touches.begin_step();
  joints.tell(records_touches ? &touches : nullptr);
  held_forces.note(world, bodies, mirror.get());
  for (Body& body : bodies.slots())
    if (body.body) set_damping(body, h);
}

void OdeWorld::Impl::end_step() {
  for (Body& body : bodies.slots()) {
    body.force = body.torque = Vec3::Zero(), body.kept_awake = false;
    if (body.is_awake())
      body.held_force = body.held_torque = Vec3::Zero();
    else if (body.body)  // ODE would keep it, and add the next step's
      set_force(body.body, Vec3::Zero(), Vec3::Zero());
  }
  collision.end_step();
  has_looked = false;
}

// What a caller's own step was given up on cannot be repeated; but it would be met again with the same
// contacts in the next one, and its bodies go on falling. So these begin as a repeated substep's do, the
// softer the more often.
void OdeWorld::Impl::begin_callers_substep(double h) {
  count_messages();
  callers_messages = messages_of_this_thread();
  was_quick_step = false;
  begin_substep(h, callers_attempt);
}

void OdeWorld::Impl::end_callers_substep(double h) {
  if (messages_of_this_thread() != callers_messages)
    callers_attempt = std::min(callers_attempt + 1, ContactJoints::kMostAttempts - 1), callers_calm = 0;
  else if (++callers_calm >= kCalm)
    callers_attempt = callers_calm = 0;
  end_substep(h);
}

// ODE's solver gives up on some degenerate systems (two bodies falling freely in full contact), saying so in
// a message and leaving the bodies without their contact forces. Such a substep is taken back and repeated
// with contacts a little softer and more uneven, and at last by QuickStep, which has nothing to give up on:
// bodies once let fall into each other are thrown apart later (a heap of plates: energy × 2). Of a caller's
// bodies those are taken back that are known: that have geoms in his space, or joints with one that has.
void OdeWorld::Impl::substep(double h) {
  sweep.begin(bodies);
  bool solved = try_substep(h);
  for (int attempt = 1; !solved && attempt < ContactJoints::kMostAttempts; ++attempt)
    solved = retry_substep(h, attempt, false);
  if (!solved && !retry_substep(h, 0, true)) energy_bound.keep(bodies);
  end_substep(h);
}

/// False where ODE had something to complain of.
bool OdeWorld::Impl::try_substep(double h) {
  held_forces.give();
  held_forces.note_states();
  energy_bound.begin(bodies);
  begin_substep(h);
  return advance(h, false);
}

bool OdeWorld::Impl::retry_substep(double h, int attempt, bool by_quick_step) {
  joints.end();
  take_back_bodies();
  held_forces.take_back();
  held_forces.give();
  find_contacts(h, attempt);
  turn_to_impacts();
  return advance(h, by_quick_step);
}

void OdeWorld::Impl::begin_substep(double h, int attempt) {
  find_contacts(h, attempt);
  sleep.run(bodies, joints, h);
  turn_to_impacts();
}

void OdeWorld::Impl::find_contacts(double h, int attempt) {
  push_bodies();
  joints.begin(h, attempt, was_quick_step ? settings.quick_step_layer : 0.0);
  {
    const Timing timing(times.collision_ms);
    collision.collide(bodies, joints, h);
  }
}

// Not moved: the solver looks at contacts from the centre of mass only. recover_bodies turns them back.
void OdeWorld::Impl::turn_to_impacts() {
  for (const Body& body : bodies.slots())
    if (body.is_awake() && body.impact)
      ode::set_orientation(body.body, turned_on(state_of(body.body), body.impact->time));
}

void OdeWorld::Impl::end_substep(double h) {
  if (records_touches) touches.end_substep(h);
  joints.end();
  recover_bodies();
  if (mirror) mirror->follow();
  counters.passes_prevented += sweep.stop_passing(bodies, collision.broad_phase(), joints.contacts());
}

// Who slept, or fell asleep in this substep, sleeps on: the sleep law has been asked already.
void OdeWorld::Impl::take_back_bodies() {
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    RigidState before = body.last_good;
    if (!body.was_enabled || body.fell_asleep) {
      before.velocity = before.angular_velocity = Vec3::Zero();
      dBodyDisable(body.body);
    }
    ode::set_state(body.body, before);
    if (body.fell_asleep) collision.broad_phase().note_sleep(body);  // contacts are found once more
  }
}

void OdeWorld::Impl::push_bodies() {
  for (const Body& body : bodies.slots()) {
    if (!body.body) continue;
    if (!dBodyIsEnabled(body.body)) {
      if (is_held(body)) set_force(body.body, body.held_force, body.held_torque);
      continue;
    }
    const Vec3 force = body.force + body.held_force, torque = body.torque + body.held_torque;
    if (!force.isZero(0.0)) dBodyAddForce(body.body, force.x(), force.y(), force.z());
    if (!torque.isZero(0.0)) dBodyAddTorque(body.body, torque.x(), torque.y(), torque.z());
  }
}

/// False where ODE had something to complain of.
bool OdeWorld::Impl::advance(double h, bool by_quick_step) {
  const Timing timing(times.response_ms);
  const std::int64_t messages_before = messages_of_this_thread();
  const std::span<const OdeContact> contacts = joints.contacts();
  energy_bound.note(bodies, contacts, joints.gravity(), joints.pushing(), h);
  const int most = joints.is_uneven() ? settings.uneven_direct_contacts_max : settings.direct_contacts_max;
  const bool too_many = int(contacts.size()) > most && largest_island(contacts) > most;
  try {
    const RecoverableScope scope;
    was_quick_step = settings.quick_step || by_quick_step || too_many;
    if (was_quick_step) {
      ++counters.quick_steps;
      count_uneven_contacts();
      const SeededRandom random(settings.seed + 0x9e3779b97f4a7c15u * ++quick_steps);
      dWorldQuickStep(world, h);
    } else {
      dWorldStep(world, h);
    }
  } catch (const AssertionFailed& failed) {
    fail(failed.message);
  }
  return messages_of_this_thread() == messages_before && energy_bound.is_kept(bodies);
}

// ODE's step was left half-way. Suspected is a body whose state it has spoilt, else the lightest of those
// awake.
void OdeWorld::Impl::fail(const std::string& message) {
  const Body* suspect = nullptr;
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    if (!is_sound(state_of(body.body))) {
      suspect = &body;
      break;
    }
    if (!suspect || body.mass() < suspect->mass()) suspect = &body;
  }
  failure = suspect
                ? fmt::format("ODE gave up in a step ({}), most likely over the body of shape {} and {:g} kg",
                              message, suspect->shape->name, suspect->mass())
                : fmt::format("ODE gave up in a step ({}), over a body of the caller's own", message);
  if (threading) threading->abandon();
  if (suspect) failed_over = suspect->id.value;
  throw SimulationError(failure, failed_over);
}

void OdeWorld::Impl::count_uneven_contacts() {
  for (const OdeContact& contact : joints.contacts()) {
    if (!contact.second) continue;
    const auto [lighter, heavier] =
        std::minmax({bodies.find(contact.first).mass(), bodies.find(contact.second).mass()});
    if (heavier >= kUneven * lighter) ++counters.uneven_contacts;
  }
}

void OdeWorld::Impl::recover_bodies() {
  for (Body& body : bodies.slots()) {
    if (!body.body) continue;
    body.was_enabled = dBodyIsEnabled(body.body);
    collision.broad_phase().note_sleep(body);
    if (body.was_enabled)
      body.joints_at_rest = 0;
    else if (body.joints_at_rest == 0)
      body.joints_at_rest = sum_up_joints(body.body);
    if (!body.was_enabled) continue;
    RigidState now = state_of(body.body);
    if (is_sound(now)) {
      if (body.impact) ode::set_state(body.body, now = end_of_step(body.last_good, now, *body.impact));
      body.last_good = now;
      continue;
    }
    put_back(body);
  }
}

void OdeWorld::Impl::put_back(Body& body) {
  body.last_good.velocity = body.last_good.angular_velocity = Vec3::Zero();
  ode::set_state(body.body, body.last_good);
  ++counters.states_recovered;
}

// What the caller did to a body by himself since the last step (dBodySetPosition, dBodyAddForce), before it
// can reach another.
void OdeWorld::Impl::put_back_unsound() {
  for (Body& body : bodies.slots()) {
    if (!body.body) continue;
    const bool pushed =
        !to_vec3(dBodyGetForce(body.body)).allFinite() || !to_vec3(dBodyGetTorque(body.body)).allFinite();
    if (pushed) dBodySetForce(body.body, 0, 0, 0), dBodySetTorque(body.body, 0, 0, 0);
    if (!pushed && is_sound(state_of(body.body))) continue;
    put_back(body);
    collision.broad_phase().forget(body);
  }
}

// ODE lets a sleeper hang in the air whose joint was destroyed, and be deaf to its motor and to
// dBodyAddForce.
void OdeWorld::Impl::wake_whose_joints_changed() {
  for (Body& body : bodies.slots()) {
    if (!body.body || dBodyIsEnabled(body.body) || body.properties.kinematic) continue;
    const std::uint64_t hangs_on = sum_up_joints(body.body);
    if (body.joints_at_rest == 0) body.joints_at_rest = hangs_on;
    const bool is_pushed =
        !to_vec3(dBodyGetForce(body.body)).isZero(0.0) || !to_vec3(dBodyGetTorque(body.body)).isZero(0.0);
    if (hangs_on == body.joints_at_rest && !is_pushed) continue;
    body.joints_at_rest = 0;
    wake(body.body);
  }
}

// The caller's are known within a step alone: between two of them he may have destroyed any.
void OdeWorld::Impl::wake_neighbors(const Body& body) {
  const Eigen::AlignedBox3d box = bounds_of(body);
  collision.broad_phase().wake_ours(bodies, box);
  if (mirror && has_looked)
    collision.broad_phase().wake_callers(box);
  else if (mirror)
    vacated.push_back(box);
  if (has_joints(body.body)) wake(body.body);
}

}  // namespace lodestone
