#include "lod/tables/hull_loads.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lodestone {

const HullLoads::Load* HullLoads::load_of(std::int64_t place) const {
  const auto slot = std::uint32_t(spheres_.slot[std::size_t(place)]);
  const auto load = std::ranges::lower_bound(loads_, slot, {}, &Load::slot);
  const bool known =
      load != loads_.end() && load->slot == slot && load->owner == spheres_.owner[std::size_t(place)];
  return known ? &*load : nullptr;
}

template <class Visit>
void HullLoads::each_pressed(const Visit& visit) {
  for (const Load& load : loads_) {
    if (load.slot >= spheres_.place_of_slot.size()) continue;
    const std::size_t i = spheres_.place_of_slot[load.slot];
    if (std::int64_t(i) < spheres_.awake && step_.touches(std::int64_t(i)) &&
        load_of(std::int64_t(i)) == &load)
      visit(i, Vec3(load.steady * constants_.wide_time));
  }
}

void HullLoads::press() {
  each_pressed([&](std::size_t i, const Vec3& by) { step_.add_velocity(std::int64_t(i), by); });
}

void HullLoads::take_back() {
  const Vec3 up = -settings_.gravity.normalized();
  each_pressed([&](std::size_t i, const Vec3& by) {
    if (step_.on_ground[i] != std::uint8_t(GroundState::moved))
      step_.add_velocity(std::int64_t(i), by.dot(up) * up - by);
  });
}

const Vec3* HullLoads::steady_on(std::int64_t place) const {
  const Load* load = load_of(place);
  return load ? &load->steady : nullptr;
}

const Vec3* HullLoads::borne_of_sleeper(std::int64_t place) const {
  const Load* load = load_of(place);
  return load ? &load->borne : nullptr;
}

void HullLoads::keep_as_it_was(std::int64_t place) {
  if (const Load* load = load_of(place)) new_loads_.push_back(*load);
}

// What is there in two steps running; and where the hulls press up or down less than was expected, what bore
// the body must not fling it. Along the ground, and where nothing weighs anything, momentum is kept. What a
// blow gives up or down is no load.
void HullLoads::keep(std::int64_t place, const StatisticalBody& before, StatisticalBody& after) {
  const Load* known = load_of(place);
  const Vec3 up = -settings_.gravity.normalized(),
             last =
                 (after.velocity - before.velocity) / constants_.wide_time - settings_.gravity - before.borne,
             lasts = after.struck ? Vec3(last - last.dot(up) * up) : last,
             earlier = known ? known->last : Vec3(Vec3::Zero()),
             expected = known ? known->steady : Vec3(Vec3::Zero());
  Vec3 steady = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (lasts[axis] * earlier[axis] > 0.0)
      steady[axis] = std::abs(lasts[axis]) < std::abs(earlier[axis]) ? lasts[axis] : earlier[axis];
  new_loads_.push_back({.slot = std::uint32_t(spheres_.slot[std::size_t(place)]),
                        .owner = spheres_.owner[std::size_t(place)],
                        .last = lasts,
                        .steady = steady,
                        .borne = before.borne});
  const double borne = expected.dot(up);
  if (borne != 0.0)
    after.velocity += std::max(0.0, 1.0 - last.dot(up) / borne) * borne * constants_.wide_time * up;
}

// Of those that sleep it stays.
void HullLoads::finish() {
  std::ranges::copy_if(loads_, std::back_inserter(new_loads_), [this](const Load& load) {
    if (load.slot >= spheres_.place_of_slot.size()) return false;
    const std::int64_t place = spheres_.place_of_slot[load.slot];
    return place >= spheres_.awake && load.owner == spheres_.owner[std::size_t(place)];
  });
  std::ranges::sort(new_loads_, {}, &Load::slot);
  for (Load& load : new_loads_) {
    const std::int64_t place = spheres_.place_of_slot[load.slot];
    load.place = spheres_.position(place);
    if (const Load* before = load_of(place)) load.moved = (load.place - before->place).norm();
  }
  loads_.swap(new_loads_);
  new_loads_.clear();
}

bool HullLoads::stays_in_place(std::int64_t place) const {
  const Load* load = load_of(place);
  return load && load->moved <
                     scene_.rest_law.sleep_speed(scene_.kind_of(place).shape->radius) * constants_.wide_time;
}

}  // namespace lodestone
