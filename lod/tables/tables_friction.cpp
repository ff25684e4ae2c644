// Of TablesLevel: friction of the ground under bodies that lie on a face among others. Their contacts with
// these are answered before it, and would else find them in motion in each step by what the ground has yet to
// stop.
#include <algorithm>

#include "lod/tables/tables_level.h"

namespace lodestone {

using namespace lane;

namespace {

constexpr float kSlight = 1e-3f;  // of gravity: less is not remembered

}  // namespace

bool TablesLevel::rubs_on_ground(std::int64_t place) const {
  const auto i = std::size_t(place);
  const auto state = GroundState(step_.on_ground[i]);
  return step_.flush[i] != 0 && (state == GroundState::lies || state == GroundState::settles) &&
         step_.touches(place);
}

// What it gave in the last step they have at the beginning of this one.
void TablesLevel::give_ground_friction() {
  given_friction_.clear();
  const float time = constants_.rubbed * constants_.time;
  for (const GroundFriction& known : ground_friction_) {
    if (known.slot >= spheres_.place_of_slot.size()) continue;
    const auto place = std::int64_t(place_of(std::int32_t(known.slot)));
    if (place >= spheres_.awake || spheres_.owner[std::size_t(place)] != known.owner ||
        !rubs_on_ground(place))
      continue;
    const F3 given = time * known.force;
    given_friction_.push_back({place, given});
    add_to(step_.p[std::size_t(place)], RowLanes{given.x, given.y, given.z, 0.0f});
  }
}

// From whom the ground is about to rub for the whole of the step.
void TablesLevel::take_back_ground_friction() {
  for (const auto& [place, given] : given_friction_)
    if (rubs_on_ground(place))
      add_to(step_.a[std::size_t(place)], RowLanes{-given.x, -given.y, -given.z, 0.0f});
}

// Around the last round of the ground: their velocities before it, and what friction was of the change.
void TablesLevel::begin_rubbing(std::int64_t begin, std::int64_t end,
                                std::vector<GroundFriction>& rubs) const {
  rubs.clear();
  if (!constants_.hulls || !constants_.remembers) return;
  for (std::int64_t i = begin; i < end; ++i) {
    if (!rubs_on_ground(i)) continue;
    const Row before = row_of(lanes_of(step_.p[std::size_t(i)]) + lanes_of(step_.a[std::size_t(i)]));
    rubs.push_back({std::uint32_t(spheres_.slot[std::size_t(i)]),
                    spheres_.owner[std::size_t(i)],
                    {before.x, before.y, before.z}});
  }
}

void TablesLevel::end_rubbing(std::vector<GroundFriction>& rubs) const {
  const float per_time = 1.0f / constants_.time;
  for (GroundFriction& rub : rubs) {
    const std::size_t i = place_of(std::int32_t(rub.slot));
    const Row after = row_of(lanes_of(step_.p[i]) + lanes_of(step_.a[i]));
    const Vec3& up = near_ground_.plane(step_.plane[i]).normal;
    const F3 n{float(up.x()), float(up.y()), float(up.z())},
        change = per_time * (F3{after.x, after.y, after.z} - rub.force);
    rub.force = change - dot(change, n) * n;
  }
  const float slight = kSlight * constants_.gravity;
  std::erase_if(rubs, [&](const GroundFriction& rub) { return dot(rub.force, rub.force) < slight * slight; });
}

void TablesLevel::remember_ground_friction() {
  if (!constants_.remembers) return;
  ground_friction_.clear();
  for (const std::vector<GroundFriction>& block : rubs_)
    ground_friction_.insert(ground_friction_.end(), block.begin(), block.end());
  std::ranges::sort(ground_friction_, {}, &GroundFriction::slot);
}

}  // namespace lodestone
