#include "lod/contact/crowd_islands.h"

#include <algorithm>

namespace lodestone {
namespace {

// Of an island that is small: fewer than the full level gives to dWorldStep, 150 contacts. Of 110 points a
// ball of ten boxes' weight that rolls into a stack of these comes back by .6 m/s less than in ODE
// (heavy_on_light).
constexpr std::uint32_t kFewPoints = 60;

}  // namespace

IslandKind CrowdIslands::kind_of(const Island& island) const {
  if (double(island.unevenness) >= kUnevenMasses) return IslandKind::uneven;
  const bool is_small = island.unevenness == 0.0F || (island.points <= kFewPoints && !island.on_great_heap);
  return is_small ? IslandKind::small : IslandKind::great;
}

void CrowdIslands::find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds) {
  const auto inverse_mass = [&](std::int32_t body) {
    return body < 0 ? 0.0 : bodies[std::size_t(body)].inverse_mass;
  };
  const auto is_in_great_heap = [&](std::int32_t body) {
    return body >= 0 && bodies[std::size_t(body)].in_great_heap;
  };
  sets_.set_all_apart(bodies.size());
  for (const CrowdManifold& m : manifolds)
    if (inverse_mass(m.first) > 0.0 && inverse_mass(m.second) > 0.0) sets_.join(m.second, m.first);
  islands_.assign(bodies.size(), {});
  island_of_.clear();
  for (const CrowdManifold& m : manifolds) {
    const double a = inverse_mass(m.first), b = inverse_mass(m.second);
    island_of_.push_back(sets_.root_of(a > 0.0 || m.second < 0 ? m.first : m.second));
    Island& island = islands_[std::size_t(island_of_.back())];
    island.points += m.count;
    if (a == 0.0 || b == 0.0) island.on_great_heap |= is_in_great_heap(a == 0.0 ? m.first : m.second);
    if (a > 0.0 && b > 0.0) island.unevenness = std::max({island.unevenness, float(a / b), float(b / a)});
  }
  kinds_.clear();
  most_uneven_of_great_ = 1.0;
  for (const std::int32_t i : island_of_) {
    const Island& island = islands_[std::size_t(i)];
    kinds_.push_back(kind_of(island));
    if (kinds_.back() == IslandKind::great)
      most_uneven_of_great_ = std::max(most_uneven_of_great_, double(island.unevenness));
  }
}

}  // namespace lodestone
