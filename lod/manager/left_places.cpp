#include "lod/manager/left_places.h"

#include <algorithm>

#include "lod/manager/levels.h"
#include "lod/statistical/rest_law.h"

namespace lodestone {
namespace {

// Over R: what has moved by more need not hold up any more what it did; what has moved by as much no longer
// does.
constexpr double kLeaves = 0.1, kGone = 2.5;

// Steps, of one of which it is looked who bears sleepers: what creeps has not gone far by then.
constexpr std::int64_t kStepsALook = 8;

/// m.
Vec3 place_of(const Levels& levels, std::uint32_t body) {
  const BodyRecord& record = levels.bodies[body];
  return record.statistical ? levels.statistical->position(record.statistical) : levels.state(body).position;
}

/// Whether it is slow enough for what sleeps on it not to feel it go: what is faster wakes it by its touch.
bool may_creep(const Levels& levels, std::uint32_t body) {
  constexpr double kSurely = 2.0;  // times the speed of that: it may be touched while it slows down
  const double wake_speed =
      RestLaw(levels.statistical_settings.sleep).wake_speed(levels.bodies.shape(body)->radius);
  return levels.state(body).velocity.norm() < kSurely * wake_speed;
}

/// Whether a body at `below` may bear the weight of one at `above`; `down`: along gravity, of length 1.
bool lies_under(const Vec3& below, const Vec3& above, const Vec3& down) {
  constexpr double kSteepest = 0.5;  // cosine, of the line through both with gravity
  const Vec3 between = below - above;
  return between.dot(down) >= kSteepest * between.norm();
}

}  // namespace

void LeftPlaces::note_place(const Levels& levels, BodyId body) {
  if (!levels.bodies.valid(body)) return;
  if (slept_at_.size() <= body.index) slept_at_.resize(std::size_t(body.index) + 1, Vec3::Zero());
  slept_at_[body.index] = levels.state(body.index).position;
}

void LeftPlaces::watch(const Levels& levels, BodyId body, const Vec3& from) {
  awake_.push_back({body, from, kLeaves * levels.bodies.shape(body.index)->radius});
}

void LeftPlaces::watch_who_bears(const Levels& levels, std::span<const BodyId> sleepers,
                                 std::span<const std::uint32_t> awake, const MayBear& may_bear) {
  if (sleepers.empty() || awake.empty()) return;
  const auto reach_of = [&](std::uint32_t body) {
    return (1.0 + kTouchMargin) * levels.bodies.shape(body)->radius;
  };
  NearFull near;
  for (const BodyId body : sleepers)
    if (levels.bodies.valid(body) && levels.asleep(body.index))
      near.add(body.index, place_of(levels, body.index), reach_of(body.index));
  std::vector<bool> watched(levels.bodies.indices(), false);
  for (const auto& [body, from, next] : awake_)
    if (levels.bodies.valid(body) &&
        (place_of(levels, body.index) - from).norm() <= kLeaves * levels.bodies.shape(body.index)->radius)
      watched[body.index] = true;
  for (const std::uint32_t body : awake) {
    if (watched[body]) continue;
    const Vec3 place = place_of(levels, body);
    bool bears = false;
    near.find(place, reach_of(body), [&](std::uint32_t sleeper) {
      const Vec3 above = place_of(levels, sleeper);
      bears |= (above - place).norm() <= reach_of(body) + reach_of(sleeper) && may_bear(body, place, above);
    });
    if (bears) watch(levels, levels.bodies.id(body), place);
  }
}

// One that is pushed, or that creeps, may be kept awake while another sleeps on it, or leans on it if it is
// full.
void LeftPlaces::watch_who_bears(const Levels& levels, std::span<const BodyId> slept) {
  std::vector<std::uint32_t> awake;
  if (!slept.empty())
    for (const FullLevel::Member& member : levels.full.members())
      if (!levels.asleep(member.owner)) awake.push_back(member.owner);
  watch_who_bears(levels, slept, awake, [](std::uint32_t, const Vec3&, const Vec3&) { return true; });
  fresh_.insert(fresh_.end(), slept.begin(), slept.end());
  if (fresh_.empty() || levels.now % kStepsALook != 0) return;
  const Vec3& gravity = levels.statistical_settings.gravity;
  if (levels.statistical && !gravity.isZero(0.0)) {
    awake.clear();
    levels.statistical->find_awake(awake);
    watch_who_bears(levels, fresh_, awake,
                    [&levels, down = Vec3(gravity.normalized())](std::uint32_t body, const Vec3& place,
                                                                 const Vec3& above) {
                      return lies_under(place, above, down) && may_creep(levels, body);
                    });
  }
  fresh_.clear();
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
                 moved = (place_of(levels, body.index) - from).norm();
    if (moved > next) {
      left_.push_back({from, radius});
      awake.next = std::min(2.0 * moved, kGone * radius);
    }
    return moved > kGone * radius || levels.asleep(body.index);
  });
  for (const BodyId body : slept) note_place(levels, body);
  for (const BodyId body : moved_and_slept) note_place(levels, body);
  watch_who_bears(levels, slept);
}

}  // namespace lodestone
