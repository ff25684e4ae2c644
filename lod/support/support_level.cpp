#include "lod/support/support_level.h"

#include <algorithm>

#include "lod/statistical/parting.h"
#include "reference/error.h"

namespace lodestone {
int SupportLevel::add(std::uint32_t owner, std::uint32_t kind, double mass, const RigidState& state,
                      bool asleep, bool eased) {
  StatisticalBody body;
  body.kind = kind;
  body.mass = mass;
  body.owner = owner;
  body.eased = eased ? kEasedTime : 0.0f;
  const int slot = size();
  bodies_.push_back(body);
  clips_.emplace_back();
  last_places_.push_back(state.position.allFinite() ? state.position : Vec3(Vec3::Zero()));
  angular_velocity_given_.emplace_back();
  place_awake_.push_back(-1);
  add_awake(slot);
  set_state(slot, state);
  if (asleep || eased)
    bodies_[std::size_t(slot)].placed = 0.0f;  // what comes from another rung parts by itself
  if (asleep) {
    put_to_sleep(bodies_[std::size_t(slot)]);
    angular_velocity_given_[std::size_t(slot)].reset();
    drop_awake(slot);
    lay_still(slot);
  }
  return slot;
}

std::optional<std::uint32_t> SupportLevel::remove(int slot) {
  check_that(slot >= 0 && slot < size(), "slot out of range");
  const int last = size() - 1;
  const auto at = std::size_t(slot), at_last = std::size_t(last);
  if (lies_still(slot))
    take_from_still(slot);
  else
    drop_awake(slot);
  const bool last_lies = slot != last && lies_still(last);
  if (last_lies) take_from_still(last);
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
  for (Push& push : pushes_)
    if (push.slot == last) push.slot = slot;
  const bool last_given = slot != last && angular_velocity_given_[at_last];
  const auto fill_gap = [&](auto& array) {
    array[at] = array[at_last];
    array.pop_back();
  };
  fill_gap(bodies_), fill_gap(clips_), fill_gap(last_places_), fill_gap(angular_velocity_given_),
      fill_gap(place_awake_);
  if (slot == last) return {};
  if (last_given) note_given(slot);
  if (last_lies)
    lay_still(slot);
  else
    awake_[std::size_t(place_awake_[at])] = slot, awake_in_order_ = false;
  return bodies_[at].owner;
}

void SupportLevel::add_awake(std::int32_t slot) {
  place_awake_[std::size_t(slot)] = std::int32_t(awake_.size());
  awake_in_order_ = awake_in_order_ && (awake_.empty() || awake_.back() < slot);
  awake_.push_back(slot);
}

// The last of the list takes its place there.
void SupportLevel::drop_awake(std::int32_t slot) {
  const std::int32_t place = std::exchange(place_awake_[std::size_t(slot)], -1), moved = awake_.back();
  awake_.pop_back();
  if (moved == slot) return;
  awake_[std::size_t(place)] = moved;
  place_awake_[std::size_t(moved)] = place;
  awake_in_order_ = false;
}

// So that the result of a step does not depend on who slept, or was removed, before.
void SupportLevel::put_awake_in_order() {
  if (awake_in_order_) return;
  if (!std::ranges::is_sorted(awake_)) std::ranges::sort(awake_);
  for (std::size_t i = 0; i < awake_.size(); ++i) place_awake_[std::size_t(awake_[i])] = std::int32_t(i);
  awake_in_order_ = true;
}

// The list of these may hold slots that are none any more, but does not grow while bodies come and go between
// steps.
void SupportLevel::note_given(std::int32_t slot) {
  given_.push_back(slot);
  if (given_.size() < 2 * bodies_.size() + 64) return;
  std::ranges::sort(given_);
  given_.erase(std::unique(given_.begin(), given_.end()), given_.end());
  std::erase_if(given_, [this](std::int32_t listed) {
    return listed >= size() || !angular_velocity_given_[std::size_t(listed)];
  });
}

RigidState SupportLevel::state(int slot) const {
  const StatisticalBody& b = body(slot);
  const std::optional<Vec3>& given = angular_velocity_given_[std::size_t(slot)];
  return {b.position, b.orientation, b.velocity,
          given ? *given : angular_velocity(b.orientation, b.spin, *kind_of(b).shape)};
}

void SupportLevel::note_placed(int slot) { bodies_[std::size_t(slot)].placed = kPlacedTime; }

void SupportLevel::set_state(int slot, const RigidState& state) {
  wake(slot);
  StatisticalBody& body = bodies_[std::size_t(slot)];
  if (state.position.allFinite()) last_places_[std::size_t(slot)] = state.position;
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *kind_of(body).shape);
  const bool given_before = angular_velocity_given_[std::size_t(slot)].has_value();
  angular_velocity_given_[std::size_t(slot)] = state.angular_velocity;
  if (!given_before) note_given(slot);
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  note_placed(slot);
  // What no level can hold is mended, and counted, before the next step looks at it.
  if (!is_sound(body, kinetic_energy(body, *kind_of(body).shape)))
    pushes_.push_back({slot, Vec3::Zero(), Vec3::Zero()});
}

void SupportLevel::add_force(int slot, const Vec3& force, const Vec3& torque) {
  wake(slot);
  pushes_.push_back({slot, force, torque});
}

void SupportLevel::begin_step(double dt, ContactTally& tally) {
  for (const std::int32_t slot : given_)
    if (slot < size()) angular_velocity_given_[std::size_t(slot)].reset();
  if (given_.size() > 64) std::exchange(given_, {});  // of a whole scene that was added
  given_.clear();
  fell_asleep_.clear();
  put_awake_in_order();
  acting_.clear();
  before_forces_.clear();
  for (const auto& [slot, force, torque] : pushes_) {
    StatisticalBody& body = bodies_[std::size_t(slot)];
    body.motion = Motion::dynamic;  // a settling clip knows no force but gravity
    before_forces_.push_back({slot, body.velocity, body.spin});
    const double share = properties_of(body).kinematic ? 0.0 : 1.0 / body.mass;
    const ActingForce acting{slot, share * force, share * torque};
    body.velocity += dt * acting.acceleration;
    body.spin += dt * acting.turning;
    if (is_sound(body, kinetic_energy(body, *kind_of(body).shape))) {
      if (!acting.is_none()) acting_.add(acting);
    } else {
      recover(body, last_places_[std::size_t(slot)], tally);
      before_forces_.back() = {slot, body.velocity, body.spin};
    }
  }
  pushes_.clear();
  acting_.put_in_order();
  for (const std::int32_t slot : awake_)
    last_places_[std::size_t(slot)] = bodies_[std::size_t(slot)].position;
}

void SupportLevel::end_search() {
  for (auto before = before_forces_.rbegin(); before != before_forces_.rend(); ++before) {
    StatisticalBody& body = bodies_[std::size_t(before->slot)];
    body.velocity = before->velocity, body.spin = before->spin;
  }
}

void SupportLevel::admit_guests(std::span<const StatisticalBody> guests) {
  for (const StatisticalBody& guest : guests) {
    if (guest.motion != Motion::asleep) awake_.push_back(std::int32_t(bodies_.size()));
    bodies_.push_back(guest);
  }
}

void SupportLevel::dismiss_guests() {
  bodies_.resize(clips_.size());
  std::erase_if(awake_, [this](std::int32_t index) { return is_guest(index); });
}

}  // namespace lodestone
