#include "lod/tables/ground_rubbing.h"

#include <algorithm>

namespace lodestone {

using namespace lane;

namespace {

constexpr float kSlight = 1e-3f;  // of gravity: less is not remembered

}  // namespace

bool GroundRubbing::rubs(std::int64_t place) const {
  const auto i = std::size_t(place);
  const auto state = GroundState(step_.on_ground[i]);
  return step_.flush[i] != 0 && (state == GroundState::lies || state == GroundState::settles) &&
         step_.touches(place);
}

void GroundRubbing::give() {
  given_.clear();
  const float time = constants_.rubbed * constants_.time;
  for (const Friction& known : known_) {
    if (known.slot >= spheres_.place_of_slot.size()) continue;
    const auto place = std::int64_t(scene_.place_of(std::int32_t(known.slot)));
    if (place >= spheres_.awake || spheres_.owner[std::size_t(place)] != known.owner || !rubs(place))
      continue;
    const F3 given = time * known.force;
    given_.push_back({place, given});
    add_to(step_.p[std::size_t(place)], RowLanes{given.x, given.y, given.z, 0.0f});
  }
}

void GroundRubbing::take_back() {
  for (const auto& [place, given] : given_)
    if (rubs(place)) add_to(step_.a[std::size_t(place)], RowLanes{-given.x, -given.y, -given.z, 0.0f});
}

void GroundRubbing::begin_blocks(std::size_t blocks) {
  found_.resize(std::max(found_.size(), blocks));
  for (std::size_t block = blocks; block < found_.size(); ++block) found_[block].clear();
}

void GroundRubbing::begin_round(std::size_t block, std::int64_t begin, std::int64_t end) {
  std::vector<Friction>& found = found_[block];
  found.clear();
  if (!constants_.hulls || !constants_.remembers) return;
  for (std::int64_t i = begin; i < end; ++i) {
    if (!rubs(i)) continue;
    const Row before = row_of(lanes_of(step_.p[std::size_t(i)]) + lanes_of(step_.a[std::size_t(i)]));
    found.push_back({std::uint32_t(spheres_.slot[std::size_t(i)]),
                     spheres_.owner[std::size_t(i)],
                     {before.x, before.y, before.z}});
  }
}

void GroundRubbing::end_round(std::size_t block) {
  std::vector<Friction>& found = found_[block];
  const float per_time = 1.0f / constants_.time;
  for (Friction& rub : found) {
    const std::size_t i = scene_.place_of(std::int32_t(rub.slot));
    const Row after = row_of(lanes_of(step_.p[i]) + lanes_of(step_.a[i]));
    const Vec3& up = ground_.plane(step_.plane[i]).normal;
    const F3 n{float(up.x()), float(up.y()), float(up.z())},
        change = per_time * (F3{after.x, after.y, after.z} - rub.force);
    rub.force = change - dot(change, n) * n;
  }
  const float slight = kSlight * constants_.gravity;
  std::erase_if(found, [&](const Friction& rub) { return dot(rub.force, rub.force) < slight * slight; });
}

void GroundRubbing::remember() {
  if (!constants_.remembers) return;
  known_.clear();
  for (const std::vector<Friction>& block : found_) known_.insert(known_.end(), block.begin(), block.end());
  std::ranges::sort(known_, {}, &Friction::slot);
}

}  // namespace lodestone
