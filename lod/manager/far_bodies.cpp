#include "lod/manager/far_bodies.h"

#include <algorithm>
#include <cmath>

namespace lodestone {

void FarBodies::put(std::uint32_t body, double due) {
  const auto place = std::int32_t(std::clamp(std::floor(due / kWidth), -1e9, 1e9));
  if (body >= place_of_.size()) place_of_.resize(body + 1, kNowhere);
  if (place_of_[body] == place) return;
  bodies_ += place_of_[body] == kNowhere;
  place_of_[body] = place;
  places_[place].push_back(body);
  ++entries_;
  if (entries_ > 2 * bodies_ + 1024) drop_stale();
}

void FarBodies::forget(std::uint32_t body) {
  if (body >= place_of_.size() || place_of_[body] == kNowhere) return;
  place_of_[body] = kNowhere;
  --bodies_;
}

void FarBodies::clear() { *this = {}; }

double FarBodies::take_next(std::vector<std::uint32_t>& bodies) {
  if (places_.empty()) return 1e300;
  const auto node = places_.extract(places_.begin());
  entries_ -= node.mapped().size();
  for (const std::uint32_t body : node.mapped())
    if (place_of_[body] == node.key()) {
      forget(body);
      bodies.push_back(body);
    }
  return (node.key() + 1) * kWidth;
}

void FarBodies::drop_stale() {
  entries_ = 0;
  for (auto place = places_.begin(); place != places_.end();) {
    std::vector<std::uint32_t>& bodies = place->second;
    std::ranges::sort(bodies);
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    std::erase_if(bodies, [&](std::uint32_t body) { return place_of_[body] != place->first; });
    entries_ += bodies.size();
    place = bodies.empty() ? places_.erase(place) : std::next(place);
  }
}

}  // namespace lodestone
