#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <utility>

#include "lod/statistical/stopwatch.h"
#include "lod/tables/tables_level.h"
#include "reference/error.h"

namespace lodestone {
namespace {

// Drops `gone` from a list in order, and where `last`, the greatest of all, is in it, puts `gone` there instead.
void rename_in_order(std::vector<std::int32_t>& list, std::int32_t last, std::int32_t gone) {
  const auto place = std::ranges::lower_bound(list, gone);
  if (place != list.end() && *place == gone) list.erase(place);
  if (list.empty() || list.back() != last) return;
  list.pop_back();
  list.insert(std::ranges::lower_bound(list, gone), gone);
}

}  // namespace

std::uint16_t StatisticalLevel::Impl::find_kind(std::shared_ptr<const Shape> shape, double mass, MaterialId material,
                                                std::shared_ptr<const Signature> signature) {
  for (std::size_t i = 0; i < kinds.size(); ++i)
    if (kinds[i].shape == shape && kinds[i].mass == mass && kinds[i].material == material && kinds[i].signature == signature) return std::uint16_t(i);
  check_that(kinds.size() < 65535, "at most 65,535 kinds of body");
  BodyKind& kind = kinds.emplace_back(make_body_kind(std::move(shape), std::move(signature), mass, material));
  if (kind.signature)
    kind.clips = ClipIndex(*kind.signature, kind.shape->inertia_per_mass / (kind.shape->radius * kind.shape->radius), ClipSettings{}.greatest_distance);
  return std::uint16_t(kinds.size() - 1);
}

void StatisticalLevel::Impl::apply_pushes(double dt, ContactTally& tally) {
  for (const auto& [slot, push] : pushes) {
    StatisticalBody& body = bodies[slot];
    const double impulse = dt / kind_of(body).mass;
    body.velocity += impulse * push.force;
    body.spin += impulse * push.torque;
    if (!is_sound(body, kinetic_energy(body, *kind_of(body).shape))) recover(body, tally);
  }
  pushes.clear();
}

StatisticalLevel::StatisticalLevel(const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials)
    : impl_(settings.model == StatisticalModel::support ? std::make_unique<Impl>(settings, ground, materials) : nullptr),
      tables_(settings.model == StatisticalModel::tables ? std::make_unique<TablesLevel>(settings, ground, materials) : nullptr) {}
StatisticalLevel::~StatisticalLevel() = default;

int StatisticalLevel::add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material, const RigidState& state,
                          bool asleep, std::shared_ptr<const Signature> signature) {
  if (tables_) return tables_->add(owner, std::move(shape), mass, material, state, asleep, std::move(signature));
  Impl& level = *impl_;
  level.reach = std::max(level.reach, shape->radius);
  StatisticalBody body;
  body.kind = level.find_kind(std::move(shape), mass, material, std::move(signature));
  body.owner = owner;
  const int slot = size();
  level.bodies.push_back(body);
  level.clips.emplace_back();
  level.last_places.push_back(state.position.allFinite() ? state.position : Vec3(Vec3::Zero()));
  level.angular_velocity_given.emplace_back();
  level.lies_still.push_back(0);
  level.near_another.push_back(0);
  level.turning.emplace_back();
  level.awake.push_back(slot);
  set_state(slot, state);
  if (asleep) {
    level.put_to_sleep(level.bodies[slot]);
    level.angular_velocity_given[slot].reset();
    level.given.pop_back();
    level.sort_by_motion();
  }
  return slot;
}

std::optional<std::uint32_t> StatisticalLevel::remove(int slot) {
  if (tables_) return tables_->remove(slot);
  Impl& level = *impl_;
  check_that(slot >= 0 && slot < size(), "slot out of range");
  const StatisticalBody gone = level.bodies[slot];
  const double radius = level.kind_of(gone).shape->radius;
  if (level.lies_still[slot]) level.take_from_still(slot);
  // What rests on it, or it on, must find new support.
  std::vector<std::int32_t> touching;
  level.still.find_near(gone.position, 1.02 * radius, [&](std::uint32_t other) {
    const StatisticalBody& body = level.bodies[other];
    if ((body.position - gone.position).norm() < 1.02 * (radius + level.kind_of(body).shape->radius)) touching.push_back(std::int32_t(other));
  });
  for (const std::int32_t other : touching) level.wake(other);
  std::ranges::sort(level.awake);

  const int last = size() - 1;
  const bool last_lies = slot != last && level.lies_still[last];
  if (last_lies) level.take_from_still(last);
  rename_in_order(level.awake, last, slot);
  std::erase_if(level.pushes, [&](const auto& push) { return push.first == slot; });
  for (auto& push : level.pushes)
    if (push.first == last) push.first = slot;
  // The list of these holds each slot once, so that it does not grow while bodies come and go between steps.
  if (level.angular_velocity_given[slot]) std::erase(level.given, slot);
  if (slot != last && level.angular_velocity_given[last]) std::ranges::replace(level.given, last, slot);
  const auto fill_gap = [&](auto& array) {
    array[slot] = array[last];
    array.pop_back();
  };
  fill_gap(level.bodies), fill_gap(level.clips), fill_gap(level.last_places), fill_gap(level.angular_velocity_given);
  fill_gap(level.lies_still), fill_gap(level.near_another), fill_gap(level.turning);
  if (last_lies) level.lay_still(slot);
  return slot == last ? std::nullopt : std::optional(level.bodies[slot].owner);
}

void StatisticalLevel::step(double dt, std::span<FullNeighbor> neighbors, StepReport& report, std::span<const FullContact> full_contacts) {
  if (tables_) return tables_->step(dt, neighbors, report, full_contacts);
  Impl& level = *impl_;
  Stopwatch watch;
  for (const std::int32_t slot : level.given)
    if (slot < size()) level.angular_velocity_given[slot].reset();
  if (level.given.size() > 64) std::exchange(level.given, {});  // of a whole scene that was added
  level.given.clear();
  ContactTally tally;
  level.apply_pushes(dt, tally);

  // 1 Near pairs: none to look for with a single body.
  level.contacts.clear();
  level.pairs.clear();
  level.pair_phase = level.bodies.size() + neighbors.size() > 1 && !level.awake.empty() + !neighbors.empty() > 0;
  if (level.pair_phase) {
    level.find_near_pairs(dt, neighbors);
    ++report.counters.pair_phases;
  } else {
    level.found.clear();
  }
  report.times.broad_phase_ms += watch.lap_ms();

  // 2 to 4 Contacts, flight and the contact solver.
  level.move(dt, neighbors, full_contacts, report.times, tally);
  watch.lap_ms();

  ++level.steps;

  // 5 Rest.
  level.sort_by_motion();
  report.times.rest_ms += watch.lap_ms();
  report.contacts += int(tally.contacts);
  report.counters.energy_clamps += tally.energy_clamps;
  report.counters.table_extrapolations += tally.table_extrapolations;
  report.counters.states_recovered += tally.states_recovered;
}

std::size_t StatisticalLevel::bytes() const { return tables_ ? tables_->bytes() : 0; }
int StatisticalLevel::size() const { return tables_ ? tables_->size() : int(impl_->bodies.size()); }
std::span<const std::int32_t> StatisticalLevel::awake() const { return tables_ ? tables_->awake() : std::span<const std::int32_t>(impl_->awake); }
int StatisticalLevel::asleep_count() const { return tables_ ? tables_->asleep_count() : int(impl_->asleep_count); }

Vec3 StatisticalLevel::position(int slot) const { return tables_ ? tables_->position(slot) : impl_->bodies[slot].position; }

RigidState StatisticalLevel::state(int slot) const {
  if (tables_) return tables_->state(slot);
  const StatisticalBody& body = impl_->bodies[slot];
  const std::optional<Vec3>& given = impl_->angular_velocity_given[slot];
  return {body.position, body.orientation, body.velocity,
          given ? *given : angular_velocity(body.orientation, body.spin, *impl_->kind_of(body).shape)};
}


void StatisticalLevel::set_state(int slot, const RigidState& state) {
  if (tables_) return tables_->set_state(slot, state);
  wake(slot);
  StatisticalBody& body = impl_->bodies[slot];
  if (state.position.allFinite()) impl_->last_places[slot] = state.position;
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *impl_->kind_of(body).shape);
  if (!impl_->angular_velocity_given[slot]) impl_->given.push_back(slot);
  impl_->angular_velocity_given[slot] = state.angular_velocity;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  // What no level can hold is mended, and counted, before the next step looks at it.
  if (!impl_->is_sound(body, kinetic_energy(body, *impl_->kind_of(body).shape))) impl_->pushes.push_back({slot, {}});
}

bool StatisticalLevel::asleep(int slot) const { return tables_ ? tables_->asleep(slot) : impl_->bodies[slot].motion == Motion::asleep; }
void StatisticalLevel::wake(int slot) { tables_ ? tables_->wake(slot) : impl_->wake(slot); }

void StatisticalLevel::add_force(int slot, const Vec3& force, const Vec3& torque) {
  if (tables_) return tables_->add_force(slot, force, torque);
  wake(slot);
  impl_->pushes.push_back({slot, {force, torque}});
}

void StatisticalLevel::find_sleepers(const Vec3& center, double reach, std::vector<std::int32_t>& slots) const {
  if (tables_) return tables_->find_sleepers(center, reach, slots);
  impl_->still.find_near(center, reach, [&](std::uint32_t slot) { slots.push_back(std::int32_t(slot)); });
}

double StatisticalLevel::reach() const { return tables_ ? tables_->reach() : impl_->reach; }

}  // namespace lodestone
