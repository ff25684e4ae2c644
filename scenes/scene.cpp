#include "scenes/scene.h"

#include <algorithm>

namespace lodestone {

Vec3 SceneViewpoint::position_at(double time_s) const {
  if (path.empty()) return position_m;
  if (time_s <= path.front().time_s) return path.front().position_m;
  const auto next = std::ranges::upper_bound(path, time_s, {}, &Key::time_s);
  if (next == path.end()) return path.back().position_m;
  const Key& from = *(next - 1);
  const double part = (time_s - from.time_s) / (next->time_s - from.time_s);
  return from.position_m + part * (next->position_m - from.position_m);
}

}  // namespace lodestone
