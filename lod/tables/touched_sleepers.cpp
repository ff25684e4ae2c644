#include "lod/tables/touched_sleepers.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kOnGround = 1.01;  // over R: with its centre no higher, a body may touch the plane

}  // namespace

// m, from its centre.
double TouchedSleepers::reach_of_sleeper(std::int64_t place) const {
  return 1.01 * double(constants_.hulls ? kinds_.farthest_reach[spheres_.kind[std::size_t(place)]]
                                        : spheres_.radius[std::size_t(place)]);
}

void TouchedSleepers::look_around_awake() {
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    const Vec3 position = spheres_.position(i);
    const double reach = scene_.still_reach(i);
    still_.find_near(position, reach, [&](std::uint32_t other) {
      const std::int64_t at = spheres_.place_of_slot[other];
      const double limit = reach + reach_of_sleeper(at);
      if ((spheres_.position(at) - position).squaredNorm() < limit * limit)
        pairs_.emplace_back(std::uint32_t(i), other);
    });
  }
}

void TouchedSleepers::look_around_sleepers(const CellGrid& cells) {
  for (std::int64_t at = spheres_.awake; at < spheres_.size(); ++at) {
    const Vec3 position = spheres_.position(at);
    const double own = reach_of_sleeper(at);
    const auto slot = std::uint32_t(spheres_.slot[std::size_t(at)]);
    cells.find_near(position, own + scene_.drift_reach(), [&](std::uint32_t ball) {
      if (ball >= std::uint32_t(spheres_.awake)) return;
      const double limit = scene_.still_reach(ball) + own;
      if ((spheres_.position(ball) - position).squaredNorm() < limit * limit) pairs_.emplace_back(ball, slot);
    });
  }
}

// In the cells of those awake, which lie side by side in memory, a sleeper takes a tenth of the time that one
// awake takes among the sleepers.
void TouchedSleepers::find_pairs(const CellGrid& cells) {
  constexpr std::int64_t kMany = 8;  // sleepers for each that is awake
  pairs_.clear(), left_asleep_.clear();
  if (still_.empty()) return;
  if (spheres_.size() - spheres_.awake > kMany * spheres_.awake)
    look_around_awake();
  else
    look_around_sleepers(cells);
  if (settings_.pair_filter)
    std::erase_if(pairs_, [&](const auto& touch) {
      return !settings_.pair_filter(spheres_.owner[touch.first],
                                    spheres_.owner[spheres_.place_of_slot[touch.second]]);
    });
  std::ranges::sort(pairs_);
}

void TouchedSleepers::find(TaskRef wake) {
  if (pairs_.empty()) return;
  for (const auto& [place, slot] : pairs_) {
    const std::int64_t at = spheres_.place_of_slot[slot];
    if (at < spheres_.awake) continue;
    const auto [normal, gap] = scene_.separate(place, at);
    const Vec3 velocity = spheres_.velocity(place);
    const bool touches =
        gap + velocity.dot(normal) * constants_.wide_time <=
        0.01 * std::min(scene_.kind_of(place).shape->radius, scene_.kind_of(at).shape->radius);
    if (!touches) continue;
    if (velocity.norm() > rest_law_.wake_speed(scene_.kind_of(at).shape->radius))
      wake(slot);
    else
      left_asleep_.push_back({std::int64_t(place), slot, normal});
  }
  wake_struck(wake);
  for (auto& touch : pairs_) touch.second = spheres_.place_of_slot[touch.second];
}

bool TouchedSleepers::any_blow() const {
  double slowest = 1e300;  // m/s
  for (const Touch& touch : left_asleep_)
    slowest = std::min(
        slowest,
        rest_law_.wake_speed(scene_.kind_of(std::int64_t(scene_.place_of(int(touch.slot)))).shape->radius));
  bool any = false;
  contacts_.each([&](const SphereContact& c) { any |= double(c.closing) < -slowest; });
  return any;
}

// Returns its number.
std::int32_t TouchedSleepers::add_body(std::int64_t place) {
  const double radius = scene_.kind_of(place).shape->radius;
  Vec3 ground = Vec3::Zero();
  double least = kOnGround * radius;
  for (const HalfSpace& plane : scene_.ground.planes())
    if (const double height = plane.height_of(spheres_.position(place)); height < least)
      least = height, ground = plane.normal;
  places_.push_back(place);
  return blows_.add_body({.mass = 1.0 / spheres_.inverse_mass[std::size_t(place)],
                          .wake_speed = rest_law_.wake_speed(radius),
                          .asleep = place >= spheres_.awake,
                          .ground = ground});
}

// Those that a blow sets in motion through others: where such a sleeper stays asleep the blow is lost in it.
void TouchedSleepers::wake_struck(TaskRef wake) {
  if (left_asleep_.empty() || !any_blow()) return;
  numbered_.assign(std::size_t(spheres_.awake), -1);
  places_.clear();
  const auto number_of = [&](std::int64_t place) {
    std::int32_t& number = numbered_[std::size_t(place)];
    return number < 0 ? number = add_body(place) : number;
  };
  blows_.clear();
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= std::uint32_t(spheres_.awake)) return;
    const MaterialId first = scene_.kind_of(c.first).material, second = scene_.kind_of(c.second).material;
    blows_.add_contact(number_of(c.first), number_of(c.second),
                       Vec3(double(c.nx), double(c.ny), double(c.nz)), -double(c.closing),
                       scene_.materials.law(first, second).restitution);
  });
  std::int32_t last_number = -1;
  std::uint32_t last_slot = ~0u;
  std::ranges::sort(left_asleep_, {}, [](const Touch& touch) { return std::pair(touch.slot, touch.place); });
  for (const auto& [place, slot, normal] : left_asleep_) {
    const auto at = std::int64_t(scene_.place_of(int(slot)));
    if (slot != last_slot) last_slot = slot, last_number = add_body(at);
    blows_.add_contact(number_of(place), last_number, normal, 0.0, 0.0);
  }
  struck_slots_.clear();
  for (const std::int32_t number : blows_.find())
    struck_slots_.push_back(std::uint32_t(spheres_.slot[std::size_t(places_[std::size_t(number)])]));
  std::erase_if(left_asleep_, [&](const Touch& touch) {
    return std::ranges::find(struck_slots_, touch.slot) != struck_slots_.end();
  });
  for (const std::uint32_t slot : struck_slots_) wake(slot);
}

void TouchedSleepers::wake_left_asleep(TaskRef wake) {
  for (const Touch& touch : left_asleep_) wake(touch.slot);
  left_asleep_.clear();
}

}  // namespace lodestone
