#include "lod/manager/full_carriers.h"

#include <algorithm>

namespace lodestone {

bool FullCarriers::take(const CarriedFull& touch) {
  if (touch.full >= levels_.bodies.indices()) return false;
  const auto place = std::ranges::lower_bound(bodies_, touch.carrier);
  if (place == bodies_.end() || *place != touch.carrier) bodies_.insert(place, touch.carrier);
  return true;
}

void FullCarriers::forget(std::uint32_t body) {
  if (const auto place = std::ranges::lower_bound(bodies_, body); place != bodies_.end() && *place == body)
    bodies_.erase(place);
}

bool FullCarriers::contains(std::uint32_t body) {
  if (!std::ranges::binary_search(bodies_, body)) return false;
  if (is_near_full(body)) return true;
  forget(body);
  return false;
}

bool FullCarriers::is_near_full(std::uint32_t body) const {
  const Vec3 center = levels_.state(body).position;
  const double radius = levels_.bodies.shape(body)->radius;
  return std::ranges::any_of(levels_.full.members(), [&](const FullLevel::Member& member) {
    if (member.owner == body || levels_.bodies.properties(member.owner).kinematic) return false;
    const double reach = radius + levels_.bodies.shape(member.owner)->radius;
    return (levels_.full.world()->state(member.id).position - center).squaredNorm() < reach * reach;
  });
}

}  // namespace lodestone
