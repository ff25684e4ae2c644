#include "lod/manager/left_places.h"

#include <algorithm>
#include <optional>

#include "lod/contact/hull_gap.h"
#include "lod/manager/levels.h"
#include "lod/statistical/rest_law.h"

namespace lodestone {
namespace {

// Over R: what has moved by more need not hold up any more what it did; what has moved by as much no longer
// does.
constexpr double kLeaves = 0.1, kGone = 2.5;

// Over R: a gap across which a body of the caller's still counts as what bears a sleeper, as it may go on
// while that comes to rest.
constexpr double kBearing = 0.25;

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

constexpr double kSteepest = 0.5;  // cosine, of the line through two bodies with gravity

/// Whether a body at `below` may bear the weight of one at `above`; `down`: along gravity, of length 1.
bool lies_under(const Vec3& below, const Vec3& above, const Vec3& down) {
  const Vec3 between = below - above;
  return between.dot(down) >= kSteepest * between.norm();
}

/// Unit; zero without gravity.
Vec3 down_of(const Levels& levels) {
  const Vec3& gravity = levels.statistical_settings.gravity;
  return gravity.isZero(0.0) ? Vec3(Vec3::Zero()) : Vec3(gravity.normalized());
}

}  // namespace

void LeftPlaces::lay(const Levels& levels, BodyId body) {
  std::erase_if(awake_, [&](const Awake& awake) { return awake.body == body; });
  note_place(levels, body);
}

void LeftPlaces::note_place(const Levels& levels, BodyId body) {
  if (!levels.bodies.valid(body)) return;
  if (slept_at_.size() <= body.index) slept_at_.resize(std::size_t(body.index) + 1, Vec3::Zero());
  slept_at_[body.index] = levels.state(body.index).position;
  if (levels.asleep(body.index)) laid_.push_back(body);
}

void LeftPlaces::watch(const Levels& levels, BodyId body, const Vec3& from) {
  awake_.push_back({body, from, kLeaves * levels.bodies.shape(body.index)->radius});
}

void LeftPlaces::watch(const Levels& levels, BodyId sleeper, const RigidState& bearer_state, BodyId bearer,
                       std::uint32_t callers) {
  const Vec3 place = place_of(levels, sleeper.index);
  borne_.push_back({sleeper, place, bearer, callers,
                    bearer_state.orientation.conjugate() * (place - bearer_state.position)});
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
  for (const std::uint32_t body : awake) {
    const Vec3 place = place_of(levels, body);
    near.find(place, reach_of(body), [&](std::uint32_t sleeper) {
      const Vec3 above = place_of(levels, sleeper);
      if ((above - place).norm() <= reach_of(body) + reach_of(sleeper) && may_bear(body, place, above))
        watch(levels, levels.bodies.id(sleeper), levels.state(body), levels.bodies.id(body), 0);
    });
  }
}

// On a full body that woke, if it is larger than these: by its own measure, a tenth of its radius, it would
// be far from under them.
void LeftPlaces::watch_sleepers_on(const Levels& levels, BodyId bearer) {
  constexpr double kLarger = 1.5;
  if (levels.bodies[bearer.index].statistical) return;
  const double radius = levels.bodies.shape(bearer.index)->radius;
  std::vector<std::uint32_t> near;
  for (const Level level : {Level::full, Level::statistical})
    levels.find_near(bearer.index, 1.0 + kTouchMargin, level, near, true);
  const RigidState state = levels.state(bearer.index);
  for (const std::uint32_t sleeper : near)
    if (kLarger * levels.bodies.shape(sleeper)->radius < radius &&
        !lies_under(place_of(levels, sleeper), state.position, down_of(levels)))
      watch(levels, levels.bodies.id(sleeper), state, bearer, 0);
}

// Bodies of the caller's, whether ODE has them asleep or not: he may put them elsewhere at any time.
void LeftPlaces::watch_callers(const Levels& levels) {
  if (levels.callers.bodies.size() == 0) laid_.clear();
  if (laid_.empty()) return;
  NearFull near;
  for (const BodyId sleeper : laid_)
    if (levels.bodies.valid(sleeper) && levels.asleep(sleeper.index))
      near.add(sleeper.index, place_of(levels, sleeper.index),
               (1.0 + kBearing) * levels.bodies.shape(sleeper.index)->radius);
  laid_.clear();
  for (const CallersBodies::Placed& bearer : levels.callers.bodies.find_placed()) {
    const PlacedHull hull(*bearer.shape, bearer.state.position, bearer.state.orientation);
    near.find(bearer.state.position, bearer.shape->radius, [&](std::uint32_t sleeper) {
      const BodyProperties& own = levels.bodies.properties(sleeper);
      if (!may_meet(own.category, own.collide, bearer.bits.category, bearer.bits.collide)) return;
      const Shape& shape = *levels.bodies.shape(sleeper);
      const RigidState state = levels.state(sleeper);
      const double touching = kBearing * shape.radius;
      HullGap gap{.normal = Vec3::Zero()};
      if (!are_apart(PlacedHull(shape, state.position, state.orientation), hull, Enough(touching), gap) ||
          gap.gap <= touching)
        watch(levels, levels.bodies.id(sleeper), bearer.state, {}, bearer.owner);
    });
  }
}

// A full one that is pushed, or that creeps, may be kept awake while another sleeps on it, or leans on it.
void LeftPlaces::watch_full_who_bear(const Levels& levels, std::span<const BodyId> slept) {
  if (slept.empty()) return;
  std::vector<std::uint32_t> awake;
  for (const FullLevel::Member& member : levels.full.members())
    if (!levels.asleep(member.owner)) awake.push_back(member.owner);
  const Vec3 down = down_of(levels);
  watch_who_bears(levels, slept, awake, [&](std::uint32_t, const Vec3& place, const Vec3& sleeper) {
    return !lies_under(sleeper, place, down);
  });
}

// Likewise a statistical one.
void LeftPlaces::watch_statistical_who_bear(const Levels& levels) {
  if (fresh_.empty() || (levels.now - 1) % kStepsALook != 0) return;
  const Vec3 down = down_of(levels);
  if (levels.statistical && !down.isZero(0.0)) {
    std::vector<std::uint32_t> awake;
    levels.statistical->find_awake(awake);
    watch_who_bears(levels, fresh_, awake, [&](std::uint32_t body, const Vec3& place, const Vec3& above) {
      return lies_under(place, above, down) && may_creep(levels, body);
    });
  }
  fresh_.clear();
}

// Whether nobody is to look after it any more: since it woke, or its bearer sleeps, or since that has gone,
// and its place is among those that were left.
bool LeftPlaces::is_over(const Levels& levels, const Borne& borne) {
  const auto& [sleeper, place, bearer, callers, arm] = borne;
  if (!levels.bodies.valid(sleeper) || !levels.asleep(sleeper.index)) return true;
  std::optional<RigidState> state;
  if (!bearer) {
    state = levels.callers.bodies.state_of(callers);
  } else if (levels.bodies.valid(bearer)) {
    if (levels.asleep(bearer.index)) return true;
    state = levels.state(bearer.index);
  }
  const double radius = levels.bodies.shape(sleeper.index)->radius;
  if (state && (state->position + state->orientation * arm - place).norm() <= kLeaves * radius) return false;
  left_.push_back({place, radius});
  return true;
}

void LeftPlaces::wake(Levels& levels) {
  watch_statistical_who_bear(levels);  // here, since the end of a step is not measured for its budget
  std::erase_if(borne_, [&](const Borne& borne) { return is_over(levels, borne); });
  for (const auto& [place, radius] : left_) levels.wake_at(place, radius);
  left_.clear();
  watch_callers(levels);
}

void LeftPlaces::follow(const Levels& levels, std::span<const BodyId> slept,
                        std::span<const BodyId> moved_and_slept, std::span<const BodyId> woke) {
  for (const BodyId body : woke) {
    watch(levels, body, slept_at_[body.index]);
    watch_sleepers_on(levels, body);
  }
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
  for (const auto bodies : {slept, moved_and_slept})
    for (const BodyId body : bodies) note_place(levels, body);
  watch_full_who_bear(levels, slept);
  fresh_.insert(fresh_.end(), slept.begin(), slept.end());
}

}  // namespace lodestone
