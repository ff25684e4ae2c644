// What the policy is told of a body: where it is, what it costs and errs by on each rung, and which rungs are
// open to it.
#include <algorithm>
#include <cmath>

#include "lod/manager/choose.h"

namespace lodestone {
namespace {

// Of a game.
constexpr double kFrame_s = 1.0 / 60.0;

constexpr double kLeastSignificance = 1e-3;

// Of what it would be awake: it lies still, but it may be woken.
constexpr double kErrorOfSleepers = 0.01;

constexpr double kMostPixels = 1e4;

}  // namespace

Rule rule_for_one(const BodyLevel& level) {
  if (level.waits_for_signature && level.choice != LevelChoice::full && level.choice != LevelChoice::support)
    return Rule::signature_pending;
  return level.choice == LevelChoice::automatic &&
                 (level.least != Rung::tables || level.greatest != Rung::full)
             ? Rule::rung_range
             : Rule::forced;
}

// One that sleeps at `tables` costs nothing there, and a budget has nothing to gain from moving it to
// `support`.
RungSet Choose::open_to(const BodyLevel& level, bool asleep) const {
  const RungSet open = open_by_choice(level, asleep);
  return level.own_properties ? open.with_support_for_tables() : open;
}

RungSet Choose::open_by_choice(const BodyLevel& level, bool asleep) const {
  if (level.choice == LevelChoice::full) return {Rung::full};
  if (level.waits_for_signature && level.choice == LevelChoice::automatic)
    return RungSet{Rung::support, Rung::full}.within(
        RungSet::between(std::max(level.least, Rung::support), std::max(level.greatest, Rung::support)));
  if (level.waits_for_signature) return {Rung::support};
  if (level.choice == LevelChoice::support) return {Rung::support};
  if (level.choice == LevelChoice::tables) return {Rung::tables};
  std::optional<Rung> fixed = model_ ? std::optional(rung_of(*model_)) : std::nullopt;
  if (!fixed && limits_ && !limits_->three_rungs()) fixed = Rung::support;
  if (!fixed && level.tables_open == 0) fixed = Rung::support;
  if (!fixed && budgeted() && asleep && !level.newcomer && level.rung == Rung::tables) fixed = Rung::tables;
  const RungSet statistical = fixed ? RungSet{*fixed} : RungSet{Rung::tables, Rung::support},
                any = fixed ? RungSet{*fixed, Rung::full} : kEveryRung;
  const RungSet open = level.choice == LevelChoice::statistical ? statistical : any;
  return open.within(RungSet::between(level.least, level.greatest));
}

bool Choose::in_view(const Vec3& center, double radius) const {
  return policy_.visible ? policy_.visible(center, radius) : views_.sees(center, radius);
}

double Choose::significance(std::uint32_t body) const {
  if (!policy_.significance) return 1.0;
  const double significance = policy_.significance({body, levels_.bodies[body].generation});
  return significance >= kLeastSignificance ? std::min(significance, 1.0)
                                            : kLeastSignificance;  // for NaN, too
}

LevelCandidate Choose::seen(std::uint32_t body) const {
  const BodyLevel& level = levels_.bodies.level(body);
  return {.position = levels_.state(body).position,
          .radius = levels_.bodies.shape(body)->radius,
          .importance = level.importance,
          .rung = level.rung};
}

std::int32_t Choose::dwell_left(std::uint32_t body) const {
  const std::int64_t since = levels_.now - levels_.bodies.level(body).changed_at;
  return std::int32_t(std::max<std::int64_t>(0, policy_.min_dwell_frames - since));
}

LevelCandidate Choose::make_candidate(std::uint32_t body, RungSet open, bool asleep) {
  const BodyLevel& level = levels_.bodies.level(body);
  const BodyRecord& record = levels_.bodies[body];
  LevelCandidate candidate{.radius = levels_.bodies.shape(body)->radius,
                           .importance = level.importance * significance(body),
                           .asleep = asleep,
                           .rung = level.rung,
                           .open = open,
                           .decided_by = rule_for_one(level),
                           .newcomer = level.newcomer,
                           .put_off = level.put_off};
  candidate.dwell_left = dwell_left(body);
  if (record.statistical)
    candidate.position =
        levels_.statistical->position(record.statistical);  // all that it takes, of most bodies
  else
    candidate.position = levels_.state(body).position;
  if (policy_.look_ahead_s > 0.0 && !asleep)
    candidate.ahead = policy_.look_ahead_s * levels_.state(body).velocity;
  const bool views_differ = policy_.visible || views_.any_frustum();
  if (policy_.out_of_view_factor > 1.0 && views_differ && !views_.empty() &&
      !in_view(candidate.position, candidate.radius))
    candidate.view_factor = policy_.out_of_view_factor;
  if (budgeted() && record.ode && !asleep)
    candidate.motion = kFrame_s * levels_.full.world()->state(record.ode).velocity;
  return candidate;
}

Activity Choose::activity(std::uint32_t body) const {
  const BodyRecord& record = levels_.bodies[body];
  if (record.statistical) return levels_.statistical->activity(record.statistical);
  if (!record.ode) return Activity::alone;
  if (levels_.full.world()->asleep(record.ode)) return Activity::asleep;
  return levels_.full.touches(record.ode) ? Activity::crowded : Activity::alone;
}

// `tables` needs a signature, and a source may have none.
void Choose::ask_for_tables(std::uint32_t body) {
  const BodyRecord& record = levels_.bodies[body];
  levels_.bodies.level(body).tables_open =
      levels_.own_signature(body) ||
      levels_.signatures.find(*levels_.bodies.shape(body), levels_.ground_law(record.material)) != nullptr;
}

void Choose::note_waiting(std::uint32_t body) {
  BodyLevel& level = levels_.bodies.level(body);
  if (level.waits_for_signature || level.choice == LevelChoice::full) return;
  if (levels_.signatures.ready(*levels_.bodies.shape(body),
                               levels_.ground_law(levels_.bodies[body].material)))
    return;
  level.waits_for_signature = true;
  waiting_.push_back(body);
}

void Choose::supply_waiting(const std::function<void(std::uint32_t)>& supply) {
  constexpr std::size_t kAskedAbout = 128;
  for (std::size_t left = std::min(kAskedAbout, waiting_.size()); left > 0; --left) {
    if (next_waiting_ >= waiting_.size()) next_waiting_ = 0;
    const std::uint32_t body = waiting_[next_waiting_];
    const bool gone = !levels_.bodies.alive(body) || !levels_.bodies.level(body).waits_for_signature;
    if (!gone && !levels_.signatures.ready(*levels_.bodies.shape(body),
                                           levels_.ground_law(levels_.bodies[body].material))) {
      ++next_waiting_;
      continue;
    }
    if (!gone) {
      BodyLevel& level = levels_.bodies.level(body);
      level.waits_for_signature = false;
      try {
        if (!level.newcomer && level.rung == Rung::support) supply(body);
      } catch (...) {
        level.waits_for_signature = true;
        throw;
      }
      note(body);
    }
    waiting_[next_waiting_] = waiting_.back();
    waiting_.pop_back();
  }
}

double Choose::pixels(const LevelCandidate& seen) const {
  if (views_.empty()) return 0.0;
  const double squared = views_.squared(seen.position, Measure::size), diameter = 2.0 * seen.radius;
  return std::min(kMostPixels, diameter / std::sqrt(squared));  // infinite at a viewpoint itself
}

void Choose::predict_errors(std::uint32_t body, Activity does, LevelCandidate& candidate) const {
  const std::array<RungError, kRungs> errors = levels_.errors_of(body, does);
  const double weight = pixels(candidate) * candidate.importance / candidate.view_factor *
                        (does == Activity::asleep ? kErrorOfSleepers : 1.0);
  for (std::size_t rung = 0; rung < kRungs; ++rung)
    candidate.error[rung] = float(weight * errors[rung].drift);
}

// What is about to hit a full body is as near as that is. One that is full only for that does not pass it on.
void Choose::look_ahead() {
  std::vector<std::size_t> full;
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (candidates_[i].rung == Rung::full && !candidates_[i].newcomer &&
        levels_.bodies.level(asked_[i]).reason != Rule::look_ahead)
      full.push_back(i);
  for (LevelCandidate& candidate : candidates_) {
    const bool fast = candidate.ahead.squaredNorm() > candidate.radius * candidate.radius;
    if (fast && !candidate.decided() && candidate.open.has(Rung::full)) look_ahead(candidate, full);
  }
}

void Choose::look_ahead(LevelCandidate& candidate, std::span<const std::size_t> full) const {
  for (const std::size_t i : full) {
    const LevelCandidate& other = candidates_[i];
    if (&other == &candidate) continue;
    const Vec3 apart = other.position - candidate.position, approach = candidate.ahead - other.ahead;
    const double length = approach.squaredNorm(),
                 along = length > 0.0 ? std::clamp(apart.dot(approach) / length, 0.0, 1.0) : 0.0;
    const double reach = candidate.radius + other.radius;
    if (along == 0.0 || (apart - along * approach).squaredNorm() > reach * reach) continue;
    candidate.hits_full = true;
    candidate.no_farther_than = std::min(
        candidate.no_farther_than, remoteness(other, views_, limits_ ? limits_->measure : Measure::distance));
  }
}

}  // namespace lodestone
