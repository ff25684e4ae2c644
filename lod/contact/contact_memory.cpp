#include "lod/contact/contact_memory.h"

namespace lodestone {
namespace {

// Calls `visit(key, begin, end)` for each run of equal keys, with its points.
template <class Visit>
void each_run(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end] == keys[begin]) ++end;
    visit(keys[begin], manifolds[begin].begin, manifolds[end - 1].begin + manifolds[end - 1].count);
  }
}

}  // namespace

void ContactMemory::recall(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                           std::span<CrowdPoint> points, double step) {
  std::size_t expected = 0;
  each_run(keys, manifolds, [&](ContactKey key, std::uint32_t begin, std::uint32_t end) {
    const std::int32_t place = place_.find(key, expected);
    if (place < 0) return;
    expected = std::size_t(place) + 1;
    const Run& run = runs_[std::size_t(place)];
    const auto before = std::span(forces_).subspan(run.begin, run.count);
    if (run.count == end - begin) {
      for (std::uint32_t i = begin; i < end; ++i) points[i].guess = step * before[i - begin];
      return;
    }
    Vec3 sum = Vec3::Zero();
    for (const Vec3& force : before) sum += force;
    for (std::uint32_t i = begin; i < end; ++i) points[i].guess = step / double(end - begin) * sum;
  });
}

void ContactMemory::remember(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                             std::span<const CrowdPoint> points, double step) {
  runs_.clear();
  forces_.clear();
  place_.clear();
  for (const CrowdPoint& point : points) forces_.push_back(point.impulse / step);
  each_run(keys, manifolds, [&](ContactKey key, std::uint32_t begin, std::uint32_t end) {
    place_.add(key);
    runs_.push_back({begin, end - begin});
  });
}

}  // namespace lodestone
