#include "lod/contact/contact_memory.h"

#include <algorithm>
#include <utility>

namespace lodestone {
namespace {

// Calls `visit(key, run, begin, end)` for each run of manifolds with equal keys, with its points.
template <class Visit>
void each_run(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end] == keys[begin]) ++end;
    visit(keys[begin], std::pair(begin, end), manifolds[begin].begin,
          manifolds[end - 1].begin + manifolds[end - 1].count);
  }
}

CrowdPoint& find_nearest(std::span<CrowdPoint> points, const Vec3& arm) {
  return *std::ranges::min_element(
      points, {}, [&](const CrowdPoint& point) { return (point.arm_first - arm).squaredNorm(); });
}

}  // namespace

void ContactMemory::recall(std::span<const ContactKey> keys, std::span<CrowdManifold> manifolds,
                           std::span<CrowdPoint> points, double step) {
  std::size_t expected = 0;
  each_run(keys, manifolds, [&](ContactKey key, auto alike, std::uint32_t begin, std::uint32_t end) {
    const std::int32_t place = place_.find(key, expected);
    if (place < 0) return;
    expected = std::size_t(place) + 1;
    for (std::size_t i = alike.first; i < alike.second; ++i) manifolds[i].known = true;
    const Run& run = runs_[std::size_t(place)];
    const auto now = points.subspan(begin, end - begin);
    for (const Load& load : std::span(loads_).subspan(run.begin, run.count))
      find_nearest(now, load.arm).guess += step * load.force;
  });
}

void ContactMemory::remember(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                             std::span<const CrowdPoint> points, double step) {
  runs_.clear();
  loads_.clear();
  place_.clear();
  for (const CrowdPoint& point : points) loads_.push_back({point.impulse / step, point.arm_first});
  each_run(keys, manifolds, [&](ContactKey key, auto, std::uint32_t begin, std::uint32_t end) {
    place_.add(key);
    runs_.push_back({begin, end - begin});
  });
}

}  // namespace lodestone
