// Of TablesLevel: bodies that touch sleepers, and whom they wake.
#include <algorithm>

#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr double kOnGround = 1.01;  // over R: with its centre no higher, a body may touch the plane

}  // namespace

// Of awake bodies with sleepers; those that are hit hard enough wake.
void TablesLevel::find_still_contacts() {
  still_touches_.clear(), left_asleep_.clear();
  if (still().empty()) return;
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    const Vec3 position = spheres_.position(i);
    still().find_near(position, double(step_.reach[i]), [&](std::uint32_t other) {
      const std::int64_t at = spheres_.place_of_slot[other];
      const double limit =
          double(step_.reach[i]) +
          1.01 * double(constants_.hulls ? kinds_.farthest_reach[spheres_.kind[at]] : spheres_.radius[at]);
      if ((spheres_.position(at) - position).squaredNorm() < limit * limit)
        still_touches_.emplace_back(std::uint32_t(i), other);
    });
  }
  if (settings_.pair_filter)
    std::erase_if(still_touches_, [&](const auto& touch) {
      return !settings_.pair_filter(spheres_.owner[touch.first],
                                    spheres_.owner[spheres_.place_of_slot[touch.second]]);
    });
  std::ranges::sort(still_touches_);
  for (const auto& [place, slot] : still_touches_) {
    const std::int64_t at = spheres_.place_of_slot[slot];
    if (at < spheres_.awake) continue;
    const auto [normal, gap] = scene_.separate(place, at);
    const Vec3 velocity = spheres_.velocity(place);
    const bool touches = gap + velocity.dot(normal) * constants_.wide_time <=
                         0.01 * std::min(kind_of(place).shape->radius, kind_of(at).shape->radius);
    if (!touches) continue;
    if (velocity.norm() > rest_law_.wake_speed(kind_of(at).shape->radius))
      wake(int(slot));
    else
      left_asleep_.emplace_back(place, slot);
  }
  wake_struck();
}

// Those that a blow sets in motion through others: where such a sleeper stays asleep the blow is lost in it.
void TablesLevel::wake_struck() {
  if (left_asleep_.empty()) return;
  double slowest = 1e300;  // m/s
  for (const auto& [_, slot] : left_asleep_)
    slowest =
        std::min(slowest, rest_law_.wake_speed(kind_of(std::int64_t(place_of(int(slot)))).shape->radius));
  bool any = false;
  contacts_.each([&](const SphereContact& c) { any |= double(c.closing) < -slowest; });
  if (!any) return;

  numbered_.assign(std::size_t(spheres_.awake), -1);
  blown_places_.clear();
  const auto add = [&](std::int64_t place) {
    const double radius = kind_of(place).shape->radius;
    Vec3 ground = Vec3::Zero();
    double least = kOnGround * radius;
    for (const HalfSpace& plane : ground_.planes())
      if (const double height = plane.height_of(spheres_.position(place)); height < least)
        least = height, ground = plane.normal;
    blown_places_.push_back(place);
    return blow_reach_.add_body({.mass = 1.0 / spheres_.inverse_mass[std::size_t(place)],
                                 .wake_speed = rest_law_.wake_speed(radius),
                                 .asleep = place >= spheres_.awake,
                                 .ground = ground});
  };
  const auto number_of = [&](std::int64_t place) {
    std::int32_t& number = numbered_[std::size_t(place)];
    return number < 0 ? number = add(place) : number;
  };
  blow_reach_.clear();
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= std::uint32_t(spheres_.awake)) return;
    const MaterialId first = kind_of(c.first).material, second = kind_of(c.second).material;
    blow_reach_.add_contact(number_of(c.first), number_of(c.second),
                            Vec3(double(c.nx), double(c.ny), double(c.nz)), -double(c.closing),
                            materials_.law(first, second).restitution);
  });
  std::int32_t last_number = -1;
  std::uint32_t last_slot = ~0u;
  std::ranges::sort(left_asleep_, {}, [](const auto& touch) { return std::pair(touch.second, touch.first); });
  for (const auto& [place, slot] : left_asleep_) {
    const auto at = std::int64_t(place_of(int(slot)));
    if (slot != last_slot) last_slot = slot, last_number = add(at);
    blow_reach_.add_contact(number_of(place), last_number, scene_.separate(place, at).first, 0.0, 0.0);
  }
  struck_slots_.clear();
  for (const std::int32_t number : blow_reach_.find())
    struck_slots_.push_back(std::uint32_t(spheres_.slot[std::size_t(blown_places_[std::size_t(number)])]));
  std::erase_if(left_asleep_, [&](const auto& touch) {
    return std::ranges::find(struck_slots_, touch.second) != struck_slots_.end();
  });
  for (const std::uint32_t slot : struck_slots_) wake(int(slot));
}

}  // namespace lodestone
