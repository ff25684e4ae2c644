#include "lod/support/support_level.h"

#include <algorithm>

#include "lod/statistical/parting.h"
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

int SupportLevel::add(std::uint32_t owner, std::uint16_t kind, const RigidState& state, bool asleep, bool eased) {
  StatisticalBody body;
  body.kind = kind;
  body.owner = owner;
  body.eased = eased ? kEasedTime : 0.0f;
  const int slot = size();
  bodies_.push_back(body);
  clips_.emplace_back();
  last_places_.push_back(state.position.allFinite() ? state.position : Vec3(Vec3::Zero()));
  angular_velocity_given_.emplace_back();
  lies_still_.push_back(0);
  awake_.push_back(slot);
  set_state(slot, state);
  if (asleep) {
    put_to_sleep(bodies_[std::size_t(slot)]);
    angular_velocity_given_[std::size_t(slot)].reset();
    given_.pop_back();
    lay_still(slot);
    awake_.pop_back();
  }
  return slot;
}

std::optional<std::uint32_t> SupportLevel::remove(int slot) {
  check_that(slot >= 0 && slot < size(), "slot out of range");
  const auto at = std::size_t(slot);
  if (lies_still_[at]) take_from_still(slot);
  std::ranges::sort(awake_);
  const int last = size() - 1;
  const auto at_last = std::size_t(last);
  const bool last_lies = slot != last && lies_still_[at_last];
  if (last_lies) take_from_still(last);
  rename_in_order(awake_, last, slot);
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
  for (Push& push : pushes_)
    if (push.slot == last) push.slot = slot;
  // The list of these holds each slot once, so that it does not grow while bodies come and go between steps.
  if (angular_velocity_given_[at]) std::erase(given_, slot);
  if (slot != last && angular_velocity_given_[at_last]) std::ranges::replace(given_, last, slot);
  const auto fill_gap = [&](auto& array) {
    array[at] = array[at_last];
    array.pop_back();
  };
  fill_gap(bodies_), fill_gap(clips_), fill_gap(last_places_), fill_gap(angular_velocity_given_), fill_gap(lies_still_);
  if (last_lies) lay_still(slot);
  return slot == last ? std::nullopt : std::optional(bodies_[at].owner);
}

RigidState SupportLevel::state(int slot) const {
  const StatisticalBody& b = body(slot);
  const std::optional<Vec3>& given = angular_velocity_given_[std::size_t(slot)];
  return {b.position, b.orientation, b.velocity, given ? *given : angular_velocity(b.orientation, b.spin, *kind_of(b).shape)};
}

void SupportLevel::set_state(int slot, const RigidState& state) {
  wake(slot);
  StatisticalBody& body = bodies_[std::size_t(slot)];
  if (state.position.allFinite()) last_places_[std::size_t(slot)] = state.position;
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *kind_of(body).shape);
  if (!angular_velocity_given_[std::size_t(slot)]) given_.push_back(slot);
  angular_velocity_given_[std::size_t(slot)] = state.angular_velocity;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  // What no level can hold is mended, and counted, before the next step looks at it.
  if (!is_sound(body, kinetic_energy(body, *kind_of(body).shape))) pushes_.push_back({slot, Vec3::Zero(), Vec3::Zero()});
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
  woken_ = false;
  for (const auto& [slot, force, torque] : pushes_) {
    StatisticalBody& body = bodies_[std::size_t(slot)];
    const double impulse = dt / kind_of(body).mass;
    body.velocity += impulse * force;
    body.spin += impulse * torque;
    if (!is_sound(body, kinetic_energy(body, *kind_of(body).shape))) recover(body, last_places_[std::size_t(slot)], tally);
  }
  pushes_.clear();
  for (const std::int32_t slot : awake_) last_places_[std::size_t(slot)] = bodies_[std::size_t(slot)].position;
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
