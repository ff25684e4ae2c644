#include "reference/ode/ode_world.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "reference/error.h"
#include "reference/ode/body_joints.h"
#include "reference/ode/world_ode.h"
#include "reference/state_archive.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr double kShortestSubstep = 1e-12;  // s; over a shorter one ODE divides by what is no longer a number

// A caller's contacts keep the depth that they were made with through all substeps of a step: of the world's
// error reduction each takes its share, so that together they undo what one dWorldStep of his would, and what
// rests does not hop. Ours, which are found in each, bring their own (dContactSoftERP).
class SharedErrorReduction {
 public:
  SharedErrorReduction(dWorldID callers_world, int substeps)
      : world_(callers_world), erp_(world_ ? dWorldGetERP(world_) : 0.0) {
    if (world_) dWorldSetERP(world_, erp_ / substeps);
  }
  ~SharedErrorReduction() {
    if (world_) dWorldSetERP(world_, erp_);
  }
  SharedErrorReduction(const SharedErrorReduction&) = delete;
  SharedErrorReduction& operator=(const SharedErrorReduction&) = delete;

 private:
  dWorldID world_;
  dReal erp_;
};

void check_step(double dt, int substeps) {
  if (!(dt > 0.0 && std::isfinite(dt) && substeps > 0 && dt / substeps >= kShortestSubstep))
    throw InputError(fmt::format(
        "a step: found {} s in {} substeps, expected one substep or more, each of {} s or more and finite",
        dt, substeps, kShortestSubstep));
}

const OdeSettings& checked(const OdeSettings& settings) {
  if (!settings.gravity.allFinite())
    throw_input_error("gravity",
                      fmt::format("({:g}, {:g}, {:g}) m/s²", settings.gravity.x(), settings.gravity.y(),
                                  settings.gravity.z()),
                      "finite numbers");
  return settings;
}

// As corners, which go as they lie in memory.
void archive_boxes(StateArchive& a, std::vector<Eigen::AlignedBox3d>& boxes) {
  std::vector<Vec3> corners;
  for (const Eigen::AlignedBox3d& box : boxes) corners.push_back(box.min()), corners.push_back(box.max());
  a(corners);
  if (!a.reading()) return;
  boxes.clear();
  for (std::size_t i = 0; i + 1 < corners.size(); i += 2) boxes.emplace_back(corners[i], corners[i + 1]);
}

}  // namespace

OdeWorld::OdeWorld(const OdeSettings& settings, const MaterialTable& materials) {
  prepare();
  impl_ = std::make_unique<Impl>(nullptr, nullptr, checked(settings), materials);
}

OdeWorld::OdeWorld(dxWorld* world, dxSpace* space, const OdeSettings& settings,
                   const MaterialTable& materials) {
  check_that(world && space, "the caller's world and space are given");
  prepare();
  impl_ = std::make_unique<Impl>(world, space, settings, materials);
}

OdeWorld::~OdeWorld() = default;
OdeWorld::OdeWorld(OdeWorld&&) noexcept = default;
OdeWorld& OdeWorld::operator=(OdeWorld&&) noexcept = default;

OdeGroundId OdeWorld::add_plane(const Vec3& normal, double offset, MaterialId material) {
  impl_->joints.check_known(material);
  return impl_->collision.add_plane(normal, offset, material);
}

OdeGroundId OdeWorld::add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                                     MaterialId material) {
  impl_->joints.check_known(material);
  return impl_->collision.add_box(sides, position, orientation, material);
}

OdeGroundId OdeWorld::add_static_mesh(const Mesh& mesh, MaterialId material) {
  impl_->joints.check_known(material);
  return impl_->collision.add_mesh(mesh, material);
}

void OdeWorld::move_ground(OdeGroundId ground, const RigidState& state) {
  impl_->collision.move_ground(ground, state, impl_->bodies);
}
void OdeWorld::remove_ground(OdeGroundId ground) { impl_->collision.remove_ground(ground, impl_->bodies); }

void OdeWorld::go_on(double gone) { impl_->collision.go_on(gone); }

OdeBodyId OdeWorld::add_body(const OdeBodyDefinition& definition) {
  impl_->joints.check_known(definition.material);
  prepare();
  if (const double cfm = impl_->settings.cfm * ode::cfm_share(definition.mass);
      impl_->own_world && cfm > 0.0 && cfm < dWorldGetCFM(impl_->world))
    dWorldSetCFM(impl_->world, cfm);
  return impl_->bodies.add(impl_->world, definition, impl_->settings, impl_->trimeshes);
}

void OdeWorld::remove_body(OdeBodyId body, bool stays) {
  const Body& removed = impl_->bodies.find(body);
  if (!stays) impl_->wake_neighbors(removed);
  impl_->collision.broad_phase().forget(removed);
  impl_->bodies.remove(body);
}

void OdeWorld::step(double dt, int substeps) {
  check_step(dt, substeps);
  if (impl_->callers_step_s > 0.0)
    throw_input_error("a step", "one between begin_callers_step and end_callers_step", "none there");
  prepare();
  const std::int64_t messages_before = messages_of_this_thread();
  impl_->begin_step(dt / substeps);
  impl_->collision.begin_step(impl_->bodies, dt);
  if (impl_->has_work()) {
    const SharedErrorReduction shared(impl_->own_world ? nullptr : impl_->world, substeps);
    for (int i = 0; i < substeps; ++i) {
      if (i > 0) impl_->collision.move_on(i * (dt / substeps));
      impl_->substep(dt / substeps);
    }
    if (substeps > 1) impl_->collision.move_on(0.0);
  } else {
    impl_->joints.begin(dt, 0, 0.0);  // no contacts
  }
  impl_->end_step();
  impl_->counters.messages += messages_of_this_thread() - messages_before;
}

void OdeWorld::begin_callers_step(double dt) {
  check_step(dt, 1);
  if (impl_->callers_step_s > 0.0)
    throw_input_error("begin_callers_step", "it called twice", "end_callers_step between them");
  prepare();
  try {
    impl_->begin_step(dt);
    impl_->sweep.begin(impl_->bodies);
    impl_->begin_callers_substep(dt);
  } catch (...) {  // such as the pair filter's: the step has not begun
    impl_->joints.end();
    throw;
  }
  impl_->callers_step_s = dt;
}

void OdeWorld::end_callers_step() {
  if (!(impl_->callers_step_s > 0.0))
    throw_input_error("end_callers_step", "no step begun", "begin_callers_step before it");
  prepare();
  impl_->end_callers_substep(std::exchange(impl_->callers_step_s, 0.0));
  impl_->end_step();
}

void OdeWorld::look_at_callers_space() {
  prepare();
  impl_->look_at_callers_space();
}

void OdeWorld::look_away() { impl_->has_looked = false; }

const SpaceMirror* OdeWorld::callers_space() const { return impl_->mirror.get(); }
void OdeWorld::include_body(dxBody* body) { impl_->held_forces.include(body); }
void OdeWorld::exclude_body(dxBody* body) { impl_->held_forces.exclude(body); }
void OdeWorld::repeat_callers_forces() { impl_->held_forces.give(); }

RigidState OdeWorld::state(OdeBodyId body) const { return state_of(impl_->bodies.find(body).body); }
const Shape& OdeWorld::shape(OdeBodyId body) const { return *impl_->bodies.find(body).shape; }

void OdeWorld::set_state(OdeBodyId id, const RigidState& state) {
  Body& body = impl_->bodies.find(id);
  ode::set_state(body.body, state);
  impl_->collision.broad_phase().forget(body);
  body.last_good = state;
}

void OdeWorld::add_force(OdeBodyId id, const Vec3& force, const Vec3& torque) {
  if (!force.allFinite() || !torque.allFinite())
    throw InputError(
        fmt::format("a force on a body: found ({}, {}, {}) N and ({}, {}, {}) N m, expected finite numbers",
                    force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()));
  Body& body = impl_->bodies.find(id);
  body.force += force;
  body.torque += torque;
}

void OdeWorld::hold(OdeBodyId id, const Vec3& force, const Vec3& torque) {
  Body& body = impl_->bodies.find(id);
  body.held_force = force, body.held_torque = torque;
}

bool OdeWorld::asleep(OdeBodyId body) const { return !dBodyIsEnabled(impl_->bodies.find(body).body); }

void OdeWorld::set_asleep(OdeBodyId id, bool asleep) {
  Body& body = impl_->bodies.find(id);
  if (!asleep) return impl_->wake(body.body);
  dBodyDisable(body.body);
  impl_->collision.broad_phase().note_sleep(body);
}

// And what hangs together with it by joints. Where one of them wakes alone, ODE wakes the others in each of
// its steps and they are laid down again, since they are slow: what the one is given is lost in them.
void OdeWorld::Impl::wake(dBodyID body) {
  for (const dBodyID next : find_jointed_group(body)) {
    Body* const own = bodies.owner(next);
    if (own && !dBodyIsEnabled(next)) own->held_force = own->held_torque = Vec3::Zero();
    if (next == body || !dBodyIsEnabled(next)) dBodyEnable(next);
    if (!own) continue;
    own->to_sleep_s = sleep.law().time;
    collision.broad_phase().note_sleep(*own);
  }
}

const BodyProperties& OdeWorld::properties(OdeBodyId body) const {
  return impl_->bodies.find(body).properties;
}
void OdeWorld::set_properties(OdeBodyId body, const BodyProperties& properties) {
  ode::set_properties(impl_->bodies.find(body), properties);
}
void OdeWorld::set_pair_filter(std::function<bool(OdeBodyId, OdeBodyId)> filter) {
  impl_->collision.broad_phase().set_pair_filter(std::move(filter));
}
void OdeWorld::keep_awake(OdeBodyId body) { impl_->bodies.find(body).kept_awake = true; }
void OdeWorld::set_sleep_law(const SleepLaw& law) { impl_->sleep.set_law(law); }

dxBody* OdeWorld::ode_body(OdeBodyId body) const { return impl_->bodies.find(body).body; }

void OdeWorld::archive(StateArchive& a) {
  prepare();
  Impl& impl = *impl_;
  if (a.reading())
    for (const Body& body : impl.bodies.slots())
      if (body.body) impl.collision.broad_phase().forget(body);
  impl.bodies.archive(a, impl.world, impl.settings, impl.trimeshes);
  if (a.reading())
    for (const Body& body : impl.bodies.slots())
      if (body.body) impl.collision.broad_phase().note_sleep(body);
  if (impl.mirror) a(*impl.mirror);
  archive_boxes(a, impl.vacated);
  a(impl.joints, impl.collision, impl.quick_steps, impl.was_quick_step, impl.callers_attempt,
    impl.callers_calm);
  double cfm = dWorldGetCFM(impl.world);
  a(cfm);
  if (impl.own_world) dWorldSetCFM(impl.world, cfm);
}

void OdeWorld::begin_anew() {
  prepare();
  Impl& impl = *impl_;
  for (const Body& body : impl.bodies.slots())
    if (body.body) impl.collision.broad_phase().forget(body);
  impl.bodies.clear();
  impl.joints.forget();
  impl.vacated.clear();
  impl.quick_steps = 0;
  impl.was_quick_step = false;
  impl.callers_attempt = impl.callers_calm = 0;
}

std::span<const OdeContact> OdeWorld::contacts() const { return impl_->joints.contacts(); }

void OdeWorld::record_touches(bool on) { impl_->records_touches = on; }
std::span<const OdeTouch> OdeWorld::touches() const { return impl_->touches.all(); }

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

}  // namespace lodestone
