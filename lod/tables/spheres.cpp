#include "lod/tables/spheres.h"

#include <algorithm>
#include <utility>

namespace lodestone {

StatisticalBody Spheres::body(std::int64_t place) const {
  StatisticalBody body;
  body.position = position(place);
  body.orientation = orientation(place);
  body.velocity = velocity(place);
  body.spin = spin(place);
  body.mass = 1.0 / inverse_mass[place];
  body.sphere_radius = radius[place];
  body.quiet_time = quiet[place];
  body.owner = owner[place];
  body.events = events[place];
  body.kind = kind[place];
  body.motion = motion[place];
  body.support_hint = support_hint[place];
  body.since_crowded = 0.001f * float(since_crowded[place]);
  body.eased = 0.008f * float(eased[place]);
  return body;
}

void Spheres::put(std::int64_t place, const StatisticalBody& body) {
  x[place] = body.position.x(), y[place] = body.position.y(), z[place] = body.position.z();
  vx[place] = body.velocity.x(), vy[place] = body.velocity.y(), vz[place] = body.velocity.z();
  lx[place] = body.spin.x(), ly[place] = body.spin.y(), lz[place] = body.spin.z();
  qw[place] = float(body.orientation.w()), qx[place] = float(body.orientation.x());
  qy[place] = float(body.orientation.y()), qz[place] = float(body.orientation.z());
  radius[place] = body.sphere_radius;
  quiet[place] = body.quiet_time;
  owner[place] = body.owner;
  events[place] = body.events;
  kind[place] = body.kind;
  motion[place] = body.motion;
  support_hint[place] = body.support_hint;
}

namespace {

// One more element; room grows by an eighth, not to twice as much.
template <class Array>
void grow(Array& array) {
  if (array.size() == array.capacity()) array.reserve(array.size() + array.size() / 8 + 16);
  array.emplace_back();
}

}  // namespace

std::int64_t Spheres::add(std::uint32_t new_owner) {
  const std::int64_t last = size();
  each_array([](auto& array) { grow(array); });
  qw[last] = 1.0f;
  owner[last] = new_owner;
  pose[last] = -1;
  clip[last] = -1;
  since_crowded[last] = 255;
  tipping_credit[last] = kWholeCredit;
  slot[last] = std::int32_t(last);
  grow(place_of_slot);
  place_of_slot.back() = std::uint32_t(last);
  swap(awake, last);
  return awake++;
}

void Spheres::swap(std::int64_t a, std::int64_t b) {
  if (a == b) return;
  each_array([&](auto& array) { std::swap(array[a], array[b]); });
  place_of_slot[std::size_t(slot[a])] = std::uint32_t(a);
  place_of_slot[std::size_t(slot[b])] = std::uint32_t(b);
}

void Spheres::remove(std::uint32_t gone) {
  std::int64_t place = place_of_slot[gone];
  if (place < awake) {
    swap(place, --awake);
    place = awake;
  }
  swap(place, size() - 1);
  const std::uint32_t last = std::uint32_t(size()) - 1;
  if (gone != last) {
    place_of_slot[gone] = place_of_slot[last];
    slot[place_of_slot[gone]] = std::int32_t(gone);
  }
  place_of_slot.pop_back();
  each_array([](auto& array) { array.pop_back(); });
}

void Spheres::wake(std::uint32_t woken) {
  const std::int64_t place = place_of_slot[woken];
  if (place < awake) return;
  motion[place] = Motion::dynamic;
  quiet[place] = 0.0f;
  known_count[place] = 0;
  held[place] = 0.0f;
  swap(place, awake++);
}

void Spheres::put_to_sleep(std::int64_t place) {
  motion[place] = Motion::asleep;
  vx[place] = vy[place] = vz[place] = lx[place] = ly[place] = lz[place] = 0.0;
  known_count[place] = 0;
  swap(place, --awake);
}

void Spheres::reorder_awake(std::span<const std::uint32_t> order, void* scratch) {
  each_array([&](auto& array) {
    using Value = typename std::decay_t<decltype(array)>::value_type;
    static_assert(sizeof(Value) <= sizeof(double));
    auto* moved = static_cast<Value*>(scratch);
    for (std::size_t i = 0; i < order.size(); ++i) moved[i] = array[order[i]];
    std::copy(moved, moved + order.size(), array.begin());
  });
  for (std::size_t i = 0; i < order.size(); ++i) place_of_slot[std::size_t(slot[i])] = std::uint32_t(i);
}

}  // namespace lodestone
