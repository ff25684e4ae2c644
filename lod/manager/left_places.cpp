#include "lod/manager/left_places.h"

#include <algorithm>

#include "lod/manager/levels.h"

namespace lodestone {
namespace {

// Over R: what has moved by more need not hold up any more what it did; what has moved by as much no longer
// does.
constexpr double kLeaves = 0.1, kGone = 2.5;

}  // namespace

void LeftPlaces::note_place(const Levels& levels, BodyId body) {
  if (!levels.bodies.valid(body)) return;
  if (slept_at_.size() <= body.index) slept_at_.resize(std::size_t(body.index) + 1, Vec3::Zero());
  slept_at_[body.index] = levels.state(body.index).position;
}

void LeftPlaces::watch(const Levels& levels, BodyId body, const Vec3& from) {
  awake_.push_back({body, from, kLeaves * levels.bodies.shape(body.index)->radius});
}

// A full body may be kept awake, by what it lies on, while another sleeps on it.
void LeftPlaces::watch_full_ones_at(const Levels& levels, BodyId sleeper) {
  std::vector<std::uint32_t> near;
  levels.find_near(sleeper.index, 1.0 + kTouchMargin, Level::full, near, false);
  for (const std::uint32_t index : near) {
    const BodyId body = levels.bodies.id(index);
    if (!levels.asleep(index) && std::ranges::find(awake_, body, &Awake::body) == awake_.end())
      watch(levels, body, levels.state(index).position);
  }
}

void LeftPlaces::wake(Levels& levels) {
  for (const auto& [place, radius] : left_) levels.wake_at(place, radius);
  left_.clear();
}

void LeftPlaces::follow(const Levels& levels, std::span<const BodyId> slept,
                        std::span<const BodyId> moved_and_slept, std::span<const BodyId> woke) {
  for (const BodyId body : woke) watch(levels, body, slept_at_[body.index]);
  std::erase_if(awake_, [&](Awake& awake) {
    const auto& [body, from, next] = awake;
    if (!levels.bodies.valid(body)) return true;
    const double radius = levels.bodies.shape(body.index)->radius,
                 moved = (levels.state(body.index).position - from).norm();
    if (moved > next) {
      left_.push_back({from, radius});
      awake.next = std::min(2.0 * moved, kGone * radius);
    }
    return moved > kGone * radius || levels.asleep(body.index);
  });
  for (const BodyId body : slept) note_place(levels, body);
  for (const BodyId body : moved_and_slept) note_place(levels, body);
  for (const BodyId body : slept) watch_full_ones_at(levels, body);
}

}  // namespace lodestone
