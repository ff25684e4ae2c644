#include "reference/ode/ode_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "reference/ode/collision_ode.h"
#include "reference/error.h"
#include "reference/ode/islands.h"
#include "reference/ode/sweep_ode.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr double kUneven = 100.0;  // QuickStep's iterations carry a weight through a body a hundredth of it no more

// Adds the time that it lives to a sum.
class Timing {
 public:
  explicit Timing(double& sum_ms) : sum_ms_(sum_ms) {}
  ~Timing() { sum_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count(); }
  Timing(const Timing&) = delete;
  Timing& operator=(const Timing&) = delete;

 private:
  double& sum_ms_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

struct OdeWorld::Impl {
  Impl(dWorldID callers_world, dSpaceID around, const OdeSettings& s, const MaterialTable& materials)
      : settings(s),
        own_world(callers_world ? nullptr : dWorldCreate()),
        world(callers_world ? callers_world : own_world),
        joints(world, s, materials),
        collision(around, s) {
    if (own_world) set_up_own_world();
  }
  ~Impl() {
    // Bodies, geoms and joints go before the world that holds them.
    joints.end();
    bodies.clear();
    threading.reset();
    if (own_world) dWorldDestroy(own_world);
  }

  void set_up_own_world() {
    threading = std::make_unique<StepThreading>(world);
    dWorldSetGravity(world, settings.gravity.x(), settings.gravity.y(), settings.gravity.z());
    dWorldSetQuickStepNumIterations(world, settings.quick_step_iterations);
    if (settings.cfm > 0.0) dWorldSetCFM(world, settings.cfm);  // friction's; without any its rows may come to depend on each other
  }

  bool has_work();
  void substep(double h);
  void push_bodies();
  bool advance(double h);
  void take_back_bodies();
  void recover_bodies();
  void count_uneven_contacts();
  void wake_neighbors(const Body& body);

  OdeSettings settings;
  dWorldID own_world, world;
  std::unique_ptr<StepThreading> threading;
  ContactJoints joints;
  Collision collision;
  Sweep sweep;
  TrimeshCache trimeshes;
  Bodies bodies;
  OdeCounters counters;
  OdeTimes times;
  std::uint64_t steps = 0;
};

OdeWorld::OdeWorld(const OdeSettings& settings, const MaterialTable& materials) {
  prepare();
  impl_ = std::make_unique<Impl>(nullptr, nullptr, settings, materials);
}

OdeWorld::OdeWorld(dxWorld* world, dxSpace* space, const OdeSettings& settings, const MaterialTable& materials) {
  check_that(world && space, "the caller's world and space are given");
  prepare();
  impl_ = std::make_unique<Impl>(world, space, settings, materials);
}

OdeWorld::~OdeWorld() = default;
OdeWorld::OdeWorld(OdeWorld&&) noexcept = default;
OdeWorld& OdeWorld::operator=(OdeWorld&&) noexcept = default;

void OdeWorld::add_plane(const Vec3& normal, double offset, MaterialId material) {
  impl_->collision.add_plane(normal, offset, material);
}

void OdeWorld::add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material) {
  impl_->collision.add_box(sides, position, orientation, material);
}

void OdeWorld::add_static_mesh(const Mesh& mesh, MaterialId material) { impl_->collision.add_mesh(mesh, material); }

OdeBodyId OdeWorld::add_body(const OdeBodyDefinition& definition) {
  prepare();
  if (const double cfm = impl_->settings.cfm * ode::cfm_share(definition.mass); impl_->own_world && cfm > 0.0 && cfm < dWorldGetCFM(impl_->world))
    dWorldSetCFM(impl_->world, cfm);
  return impl_->bodies.add(impl_->world, impl_->collision.broad_phase().bodies_space(), definition, impl_->settings,
                           impl_->trimeshes);
}

void OdeWorld::remove_body(OdeBodyId body, bool stays) {
  if (!stays) impl_->wake_neighbors(impl_->bodies.find(body));
  impl_->bodies.remove(body);
}

void OdeWorld::step(double dt, int substeps) {
  if (!(dt > 0.0 && std::isfinite(dt) && substeps > 0))
    check_that(false, "a step is positive and finite, in one substep or more:", fmt::format("dt {} s, {} substeps", dt, substeps));
  prepare();
  const std::int64_t messages_before = messages_of_this_thread();
  impl_->times = {};
  if (impl_->has_work()) for (int i = 0; i < substeps; ++i) impl_->substep(dt / substeps);
  else impl_->joints.begin(dt, 0);  // no contacts
  for (Body& body : impl_->bodies.slots()) body.force = body.torque = Vec3::Zero();
  impl_->counters.messages += messages_of_this_thread() - messages_before;
}

// Nothing moves where all sleep, save in a caller's world, whose other bodies are unknown.
bool OdeWorld::Impl::has_work() {
  return !own_world || std::ranges::any_of(bodies.slots(), [](const Body& body) { return body.body && dBodyIsEnabled(body.body); });
}

// ODE's solver gives up on some degenerate systems (two bodies falling freely in full contact), saying so in a message and leaving the
// bodies without their contact forces. Such a substep is taken back and repeated with contacts a little softer and more uneven. Not in a caller's world,
// whose other bodies cannot be taken back.
void OdeWorld::Impl::substep(double h) {
  constexpr int kAttempts = 3;
  sweep.begin(bodies);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    push_bodies();
    joints.begin(h, attempt);
    {
      const Timing timing(times.collision_ms);
      collision.collide(bodies, joints, h);
    }
    const bool solved = advance(h);
    joints.end();
    if (solved || !own_world || attempt == kAttempts - 1) break;
    take_back_bodies();
  }
  recover_bodies();
  counters.passes_prevented += sweep.stop_passing(bodies, collision.broad_phase(), joints.contacts());
}

void OdeWorld::Impl::take_back_bodies() {
  for (const Body& body : bodies.slots())
    if (body.body) ode::set_state(body.body, body.last_good);
}

void OdeWorld::Impl::push_bodies() {
  for (const Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    if (!body.force.isZero(0.0)) dBodyAddForce(body.body, body.force.x(), body.force.y(), body.force.z());
    if (!body.torque.isZero(0.0)) dBodyAddTorque(body.body, body.torque.x(), body.torque.y(), body.torque.z());
  }
}

/// False where ODE had something to complain of.
bool OdeWorld::Impl::advance(double h) {
  const Timing timing(times.response_ms);
  const std::int64_t messages_before = messages_of_this_thread();
  const std::span<const OdeContact> contacts = joints.contacts();
  const bool too_many = int(contacts.size()) > settings.direct_contacts_max && largest_island(contacts) > settings.direct_contacts_max;
  if (settings.quick_step || too_many) {
    ++counters.quick_steps;
    count_uneven_contacts();
    const SeededRandom random(settings.seed + 0x9e3779b97f4a7c15u * ++steps);
    dWorldQuickStep(world, h);
  } else {
    dWorldStep(world, h);
  }
  return messages_of_this_thread() == messages_before;
}

void OdeWorld::Impl::count_uneven_contacts() {
  const auto mass_of = [this](OdeBodyId body) {
    dMass mass;
    dBodyGetMass(bodies.find(body).body, &mass);
    return mass.mass;
  };
  for (const OdeContact& contact : joints.contacts()) {
    if (!contact.second) continue;
    const auto [lighter, heavier] = std::minmax({mass_of(contact.first), mass_of(contact.second)});
    if (heavier >= kUneven * lighter) ++counters.uneven_contacts;
  }
}

void OdeWorld::Impl::recover_bodies() {
  for (Body& body : bodies.slots()) {
    if (!body.body || !dBodyIsEnabled(body.body)) continue;
    RigidState now = state_of(body.body);
    if (is_sound(now)) {
      if (body.impact_time) ode::set_state(body.body, now = end_of_step(body.last_good, now, *body.impact_time));
      body.last_good = now;
      continue;
    }
    body.last_good.velocity = body.last_good.angular_velocity = Vec3::Zero();
    ode::set_state(body.body, body.last_good);
    ++counters.states_recovered;
  }
}

void OdeWorld::Impl::wake_neighbors(const Body& body) {
  for (dGeomID geom = dBodyGetFirstGeom(body.body); geom; geom = dBodyGetNextGeom(geom))
    collision.broad_phase().wake_around(geom);
  for (int i = 0; i < dBodyGetNumJoints(body.body); ++i)
    for (const int end : {0, 1})
      if (const dBodyID other = dJointGetBody(dBodyGetJoint(body.body, i), end)) dBodyEnable(other);
}

RigidState OdeWorld::state(OdeBodyId body) const { return state_of(impl_->bodies.find(body).body); }

void OdeWorld::set_state(OdeBodyId id, const RigidState& state) {
  Body& body = impl_->bodies.find(id);
  ode::set_state(body.body, state);
  body.last_good = state;
}

void OdeWorld::add_force(OdeBodyId id, const Vec3& force, const Vec3& torque) {
  check_that(force.allFinite() && torque.allFinite(), "a force is finite");
  Body& body = impl_->bodies.find(id);
  body.force += force;
  body.torque += torque;
}

bool OdeWorld::asleep(OdeBodyId body) const { return !dBodyIsEnabled(impl_->bodies.find(body).body); }

void OdeWorld::set_asleep(OdeBodyId id, bool asleep) {
  const dBodyID body = impl_->bodies.find(id).body;
  asleep ? dBodyDisable(body) : dBodyEnable(body);
}

dxBody* OdeWorld::ode_body(OdeBodyId body) const { return impl_->bodies.find(body).body; }

std::span<const OdeContact> OdeWorld::contacts() const { return impl_->joints.contacts(); }

const OdeCounters& OdeWorld::counters() const {
  OdeCounters& counters = impl_->counters;
  counters.bodies_created = impl_->bodies.created();
  counters.trimeshes_built = impl_->trimeshes.built() + impl_->collision.ground_trimeshes();
  counters.contacts = impl_->joints.made();
  counters.contacts_dropped = impl_->collision.contacts_dropped();
  counters.swallowed = impl_->collision.swallowed();
  return counters;
}

const OdeTimes& OdeWorld::times() const { return impl_->times; }
dxWorld* OdeWorld::ode_world() const { return impl_->world; }
dxSpace* OdeWorld::ode_space() const { return impl_->collision.broad_phase().bodies_space(); }

}  // namespace lodestone
