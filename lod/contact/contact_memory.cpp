#include "lod/contact/contact_memory.h"

#include <algorithm>
#include <utility>

#include "lod/room.h"

namespace lodestone {
namespace {

// Calls `visit(key, begin, end)` for each run of equal keys.
template <class Visit>
void each_run(std::span<const ContactKey> keys, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end] == keys[begin]) ++end;
    visit(keys[begin], begin, end);
  }
}

// Of those that the force does not pull, if there are any: two that are in each other push each other several
// ways, and what held one way is no guess for another.
CrowdPoint& find_nearest(std::span<const CrowdManifold> manifolds, std::span<CrowdPoint> points,
                         const Vec3& arm, const Vec3& force) {
  CrowdPoint* nearest = nullptr;
  double least = 0.0;
  bool pulled = true;
  for (const CrowdManifold& m : manifolds) {
    const bool pulls = m.normal.dot(force) < 0.0;
    if (pulls && !pulled) continue;
    for (CrowdPoint& point : points.subspan(m.begin, m.count)) {
      const double distance = (point.arm_first - arm).squaredNorm();
      if (!nearest || distance < least || pulls != pulled) least = distance, nearest = &point, pulled = pulls;
    }
  }
  return *nearest;
}

}  // namespace

void ContactMemory::recall(std::span<const ContactKey> keys, std::span<CrowdManifold> manifolds,
                           std::span<CrowdPoint> points, double step, const JobRunner& jobs) {
  Loads& before = begun_ ? last_substep_ : last_step_;
  step *= begun_ ? 1.0 : shares_.of_forces;
  recalled_.clear();
  std::size_t expected = 0;
  each_run(keys, [&](ContactKey key, std::size_t first, std::size_t end) {
    const std::int32_t place = before.place.find(key, expected);
    if (place < 0) return;
    expected = std::size_t(place) + 1;
    recalled_.push_back({std::uint32_t(first), std::uint32_t(end), place});
  });
  constexpr std::int64_t kGrain = 256;
  run_in_pieces(jobs, std::int64_t(recalled_.size()), kGrain, [&](std::int64_t from, std::int64_t to) {
    for (const Recalled& pair : std::span(recalled_).subspan(std::size_t(from), std::size_t(to - from))) {
      const auto now = manifolds.subspan(pair.first, pair.end - pair.first);
      for (CrowdManifold& m : now) m.known = true;
      const Run& run = before.runs[std::size_t(pair.place)];
      for (const Load& load : std::span(before.loads).subspan(run.begin, run.count)) {
        const Vec3 force = load.force.cast<double>();
        CrowdPoint& point = find_nearest(now, points, load.arm.cast<double>(), force);
        point.guess += step * force;
        if (load.frictionless >= 0.0F)
          point.frictionless = std::max(0.0F, point.frictionless) + float(step) * load.frictionless;
      }
    }
  });
}

void ContactMemory::remember(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                             std::span<const CrowdPoint> points, double step) {
  if (!shares_.remembers) return;
  begun_ = true;
  last_substep_.clear();
  std::vector<Load>& loads = last_substep_.loads;
  each_run(keys, [&](ContactKey key, std::size_t first, std::size_t end) {
    const auto begin = std::uint32_t(loads.size());
    for (const CrowdManifold& m : manifolds.subspan(first, end - first)) {
      if (m.to_forget) continue;
      for (const CrowdPoint& point : points.subspan(m.begin, m.count)) {
        const Vec3& bears = point.in_blow ? point.guess : point.impulse;
        const float frictionless = point.in_blow ? -1.0F : point.frictionless;
        if (bears.isZero(0.0) && frictionless < 0.0F) continue;  // most points of a heap bear nothing
        append_in_room(loads) = {(bears / step).cast<float>(), point.arm_first.cast<float>(),
                                 frictionless / float(step)};
      }
    }
    last_substep_.place.add(key);
    last_substep_.runs.push_back({begin, std::uint32_t(loads.size()) - begin});
  });
}

void ContactMemory::end_islands() {
  if (!begun_) return;
  if (this_step_.runs.empty()) return std::swap(this_step_, last_substep_);
  const auto from = std::uint32_t(this_step_.loads.size());
  this_step_.place.add(last_substep_.place);
  for (const Run& run : last_substep_.runs) this_step_.runs.push_back({from + run.begin, run.count});
  this_step_.loads.insert(this_step_.loads.end(), last_substep_.loads.begin(), last_substep_.loads.end());
}

void ContactMemory::end_step() {
  if (!this_step_.runs.empty()) std::swap(last_step_, this_step_);
}

}  // namespace lodestone
