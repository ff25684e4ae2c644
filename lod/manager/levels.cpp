#include "lod/manager/levels.h"

#include <algorithm>

#include "lod/contact/hull_contacts.h"
#include "reference/ode/body_joints.h"

namespace lodestone {
namespace {

// Fewer full bodies are looked at one by one.
constexpr std::size_t kFewFull = 32;

}  // namespace

ContactLaw Levels::ground_law(MaterialId material) const {
  return materials.law(material, ground.planes().empty() ? 0 : ground.planes().front().material);
}

const std::shared_ptr<const Signature>& Levels::own_signature(std::uint32_t body) const {
  static const std::shared_ptr<const Signature> kNone;
  return bodies[body].statistical ? statistical->signature(bodies[body].statistical) : kNone;
}

std::array<RungError, kRungs> Levels::errors_of(std::uint32_t body, Activity does) const {
  RungErrors errors = signatures.errors(*bodies.shape(body), ground_law(bodies[body].material));
  if (does == Activity::crowded) {
    constexpr RungOverlaps kOverlaps;
    errors.tables.drift += kOverlaps.tables;
    errors.support.drift += kOverlaps.support;
    errors.full.drift += kOverlaps.full;
  }
  return {errors.tables, errors.support, errors.full};
}

RigidState Levels::state(std::uint32_t body) const {
  const BodyRecord& record = bodies[body];
  if (record.ode) return full.world()->state(record.ode);
  if (record.statistical) return statistical->state(record.statistical);
  return bodies.newcomer(body).state;
}

std::array<double, 15> Levels::numbers_of(std::uint32_t body) const {
  const auto [x, q, v, w] = state(body);
  const bool is_full(bodies[body].ode), sleeps = asleep(body);
  return {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(),           q.z(),         v.x(),
          v.y(), v.z(), w.x(), w.y(), w.z(), double(is_full), double(sleeps)};
}

bool Levels::asleep(std::uint32_t body) const {
  const BodyRecord& record = bodies[body];
  if (record.ode) return full.world()->asleep(record.ode);
  return record.statistical ? statistical->asleep(record.statistical) : bodies.newcomer(body).asleep;
}

void Levels::set_state(std::uint32_t body, const RigidState& state) {
  const auto wake_around = [&] {
    wake_near(body, Level::full);
    wake_near(body, Level::statistical);
  };
  const BodyRecord& record = bodies[body];
  const bool goes_away = (this->state(body).position - state.position).norm() > bodies.shape(body)->radius;
  if (goes_away && record.statistical) statistical->let_fall_near(record.statistical);
  wake_around();
  set_motion(body, state);
  wake_around();  // what it is put onto, or into
}

void Levels::set_motion(std::uint32_t body, const RigidState& state) {
  const BodyRecord& record = bodies[body];
  wake(body);
  if (record.ode)
    full.world()->set_state(record.ode, state), note_full(body), eased.forget(body);
  else if (record.statistical)
    statistical->set_state(record.statistical, state);
  else
    bodies.newcomer(body).state = state;
}

void Levels::wake(std::uint32_t body) {
  const BodyRecord& record = bodies[body];
  if (!asleep(body)) return;
  woken.push_back(body);
  if (record.ode)
    full.world()->set_asleep(record.ode, false);
  else if (record.statistical)
    statistical->wake(record.statistical);
  else
    bodies.newcomer(body).asleep = false;
}

// Where the ground moves it out of itself and into others, these are to part, too, before they sleep again.
void Levels::wake_in_ground(std::uint32_t body) {
  wake(body);
  if (const StatisticalPlace place = bodies[body].statistical) statistical->note_placed(place);
}

void Levels::put_to_sleep(std::uint32_t body) {
  const BodyRecord& record = bodies[body];
  bodies.drop_force(body);
  if (asleep(body)) return;
  if (record.statistical) return statistical->put_to_sleep(record.statistical);
  RigidState still = state(body);
  still.velocity = still.angular_velocity = Vec3::Zero();
  set_motion(body, still);
  if (record.ode)
    full.world()->set_asleep(record.ode, true);
  else
    bodies.newcomer(body).asleep = true;
}

void Levels::set_gravity(const Vec3& gravity) {
  if (gravity == statistical_settings.gravity)
    return full.set_gravity(gravity);  // a caller's world's may differ
  use_gravity(gravity);
  wake_all();
}

void Levels::use_gravity(const Vec3& gravity) {
  statistical_settings.gravity = gravity;
  full.set_gravity(gravity);
  if (statistical) statistical->set_gravity(gravity);
}

void Levels::wake_all() {
  for (std::uint32_t body = 0; body < bodies.indices(); ++body)
    if (bodies.alive(body)) wake(body);
}

void Levels::follow_callers_space(double dt, double since) {
  if (!full.world()) return;
  full.world()->look_at_callers_space();  // puts back what the caller spoilt of ours, too
  const SpaceMirror* mirror = full.world()->callers_space();
  if (!mirror) return;
  const auto wake = [this](const Eigen::AlignedBox3d& box) { wake_in(box); };
  const Vec3& gravity = statistical_settings.gravity;
  const Vec3 up = gravity.isZero(0.0) ? Vec3(Vec3::UnitZ()) : Vec3(-gravity.normalized());
  callers.ground.follow(*mirror, dt, since, up,
                        {.disturbed = wake,
                         .gone = [this](const Eigen::AlignedBox3d& box) { wake_piled_in(box); },
                         .came = [this](const HalfSpace& plane) { wake_on(plane); }});
  const auto tell = [this](std::uint32_t owner, const GroundBits& bits) { bodies.set_bits(owner, bits); };
  callers.bodies.follow(*mirror, wake, tell);
  std::vector<dxBody*> jointed;
  for (const FullLevel::Member& member : full.members())
    if (dxBody* const body = full.world()->ode_body(member.id); has_joints(body)) jointed.push_back(body);
  callers.bodies.follow_tied(jointed, tell);
}

void Levels::look_away() {
  if (full.world()) full.world()->look_away();
}

std::vector<CallersPart> Levels::callers_parts() const {
  const SpaceMirror* mirror = full.world() ? full.world()->callers_space() : nullptr;
  return mirror ? callers.bodies.find_parts(*mirror) : std::vector<CallersPart>{};
}

void Levels::wake_in(const Eigen::AlignedBox3d& box) {
  eased.wake_in(*this, box);
  for (const std::uint32_t body : find_sleepers_in(box)) wake_in_ground(body);
}

void Levels::wake_all_in(const Eigen::AlignedBox3d& box) {
  wake_in(box);
  for (const std::uint32_t body : find_full_in(box)) wake(body);
}

void Levels::wake_piled_in(const Eigen::AlignedBox3d& box) {
  std::vector<std::uint32_t> lay_there = find_sleepers_in(box);
  std::ranges::copy(find_full_in(box), std::back_inserter(lay_there));
  wake_all_in(box);
  if (full.asleep_count() + (statistical ? statistical->asleep_count() : 0) == 0) return;
  for (const std::uint32_t body : lay_there) wake_piled_on(body);
}

void Levels::wake_on(const HalfSpace& plane) {
  constexpr double kCut = 0.01;  // over R
  for (std::uint32_t body = 0; body < bodies.indices(); ++body) {
    if (!bodies.alive(body) || !asleep(body)) continue;
    const Shape& shape = *bodies.shape(body);
    const RigidState at = state(body);
    const double height = plane.height_of(at.position);
    std::int32_t hint = 0;
    if (height < shape.radius &&
        find_lowest_point(shape, at.orientation, plane.normal, height, hint).gap < -kCut * shape.radius)
      wake_in_ground(body);
  }
}

void Levels::wake_near(std::uint32_t body, Level level) {
  std::vector<std::uint32_t> near;
  find_near(body, 1.0 + kTouchMargin, level, near, true);
  std::ranges::sort(near);
  for (const std::uint32_t other : near) wake(other);
}

void Levels::wake_at(const Vec3& center, double radius) {
  std::vector<std::uint32_t> near;
  for (const Level level : {Level::full, Level::statistical})
    find_at(center, radius, 1.0 + kTouchMargin, level, near, true);
  std::ranges::sort(near);
  for (const std::uint32_t body : near) wake(body);
}

void Levels::wake_piled_on(std::uint32_t lowest) {
  constexpr double kAbove = 0.1;  // of the distance: what lies beside it is not piled on it
  const double strength = statistical_settings.gravity.norm();
  if (strength == 0.0) return;
  const Vec3 up = -statistical_settings.gravity / strength;
  std::vector<std::uint32_t> bear = {lowest}, near;
  while (!bear.empty()) {
    const std::uint32_t below = bear.back();
    bear.pop_back();
    near.clear();
    for (const Level level : {Level::full, Level::statistical})
      find_near(below, 1.0 + kTouchMargin, level, near, true);
    std::ranges::sort(near);
    for (const std::uint32_t body : near) {
      const Vec3 apart = state(body).position - state(below).position;
      if (!asleep(body) || apart.dot(up) <= kAbove * apart.norm()) continue;
      wake(body);
      bear.push_back(body);
    }
  }
}

bool Levels::meets(std::uint32_t body, const Vec3& place, const Eigen::AlignedBox3d& box) const {
  const double reach = (1.0 + kTouchMargin) * bodies.shape(body)->radius;
  return box.squaredExteriorDistance(place) <= reach * reach;
}

std::vector<std::uint32_t> Levels::find_sleepers_in(const Eigen::AlignedBox3d& box) const {
  std::vector<std::uint32_t> found;
  if (!statistical || statistical->asleep_count() == 0) return found;
  statistical->find_sleepers(box.center(), 0.5 * box.sizes().norm(), found);
  std::ranges::sort(found);
  std::erase_if(found, [&](std::uint32_t body) {
    return !meets(body, statistical->position(bodies[body].statistical), box);
  });
  return found;
}

std::vector<std::uint32_t> Levels::find_full_in(const Eigen::AlignedBox3d& box) const {
  std::vector<std::uint32_t> found;
  for (const FullLevel::Member& member : full.members())
    if (meets(member.owner, state(member.owner).position, box)) found.push_back(member.owner);
  return found;
}

void Levels::find_near(std::uint32_t body, double factor, Level level, std::vector<std::uint32_t>& near,
                       bool asleep_only) const {
  const Vec3 position = state(body).position;
  if (!position.allFinite()) return;  // the caller spoilt it, and the next step puts it back
  find_at(position, bodies.shape(body)->radius, factor, level, near, asleep_only);
  std::erase(near, body);
}

void Levels::find_at(const Vec3& center, double radius, double factor, Level level,
                     std::vector<std::uint32_t>& near, bool asleep_only) const {
  const auto add = [&](std::uint32_t body, const Vec3& place) {
    const double reach = factor * (radius + bodies.shape(body)->radius);
    if ((place - center).squaredNorm() <= reach * reach) near.push_back(body);
  };
  if (level == Level::full) {
    const auto add_full = [&](std::uint32_t body) {
      if (bodies[body].ode) add(body, full.world()->state(bodies[body].ode).position);
    };
    if (full.members().size() > kFewFull)
      near_full().find(center, factor * radius, add_full);
    else
      for (const FullLevel::Member& member : full.members()) add_full(member.owner);
    return;
  }
  if (!statistical) return;
  std::vector<std::uint32_t> owners;
  statistical->find_sleepers(center, factor * (radius + statistical->reach()) - statistical->reach(), owners);
  if (!asleep_only) statistical->find_awake(owners);
  for (const std::uint32_t owner : owners) add(owner, statistical->position(bodies[owner].statistical));
}

void Levels::note_full(std::uint32_t body) {
  if (near_full_.made())
    near_full_.add(body, full.world()->state(bodies[body].ode).position,
                   (1.0 + kTouchMargin) * bodies.shape(body)->radius);
}

const NearFull& Levels::near_full() const {
  if (near_full_.made()) return near_full_;
  near_full_.begin();
  for (const FullLevel::Member& member : full.members())
    near_full_.add(member.owner, full.world()->state(member.id).position,
                   (1.0 + kTouchMargin) * bodies.shape(member.owner)->radius);
  return near_full_;
}

void Levels::give_forces() {
  for (const std::uint32_t body : bodies.pushed()) {
    const BodyRecord& record = bodies[body];
    const auto [force, torque] = bodies.force(body);
    if (record.ode)
      full.world()->add_force(record.ode, force, torque), eased.forget(body);
    else if (record.statistical)
      statistical->add_force(record.statistical, force, torque);
  }
  bodies.clear_forces();
}

}  // namespace lodestone
