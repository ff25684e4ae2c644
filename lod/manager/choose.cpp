#include "lod/manager/choose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

// m of travel, and over the distance: by so much a body's turn comes early, for rounding.
constexpr double kEarly = 1e-6;

// Of a game.
constexpr double kFrame_s = 1.0 / 60.0;

/// m, of the one that came farthest; as many now as before.
double find_travel(std::span<const Vec3> before, std::span<const Vec3> now) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i) farthest = std::max(farthest, (now[i] - before[i]).norm());
  return farthest;
}

/// Whether the policy wanted another rung for it than it has.
bool waits(LevelReason reason) {
  return reason == LevelReason::dwell || reason == LevelReason::queued || reason == LevelReason::overlap_put_off || reason == LevelReason::most_reached;
}

}  // namespace

void Choose::set_policy(const PolicySettings& policy) {
  policy_ = policy;
  look_at_all_ = true;
}

void Choose::set_viewpoints(std::span<const Vec3> positions) {
  look_at_all_ |= positions.size() != viewpoints_.size();
  if (!look_at_all_) traveled_ += find_travel(viewpoints_, positions);
  viewpoints_.assign(positions.begin(), positions.end());
}

void Choose::add_static_bounds(const Eigen::AlignedBox3d& bounds) {
  static_bounds_.push_back(bounds);
  for (std::uint32_t body = 0; body < levels_.bodies.indices(); ++body)
    if (levels_.bodies.alive(body)) {
      if (bounds.exteriorDistance(levels_.state(body).position) < levels_.bodies.shape(body)->radius) levels_.wake(body);
    }
  look_at_all_ = true;
}

std::optional<RungChanges> Choose::run(StepReport& report, CostModel& costs) {
  const StageTimer timer(report.times.choose_ms);
  costs_ = &costs;
  costs.set_unit(std::holds_alternative<BudgetPolicy>(policy_.policy) ? CostModel::Unit::milliseconds : CostModel::Unit::work);
  if (budgeted())
    for (std::size_t activity = 0; activity < kActivities; ++activity) cost_of_[activity] = costs.cost_of(Activity(activity));
  look_at_those_concerned(report);
  if (budgeted() && !viewpoints_.empty()) look_at_nearest(report);
  counts_.asked = int(asked_.size());
  if (asked_.empty()) {
    look_at_all_ = false;
    return {};
  }
  put_in_order();
  RungChanges changes = take_answers(choose_levels(candidates_, viewpoints_, policy_, costs.overhead(counts_)));
  if (budgeted()) count_changes(changes);
  return changes;
}

// Where a budget is to be kept, what is awake costs something, seen or not.
bool Choose::sees_places() const {
  if (!static_bounds_.empty() || budgeted()) return true;
  const BodyTable& bodies = levels_.bodies;
  return !viewpoints_.empty() && bodies.count(LevelChoice::automatic) + (model_ ? 0 : bodies.count(LevelChoice::statistical)) > 0;
}

void Choose::look_at_those_concerned(StepReport& report) {
  asked_.clear();
  candidates_.clear();
  activities_.clear();
  counts_ = {};
  BodyTable& bodies = levels_.bodies;
  std::vector<std::uint32_t> some = std::exchange(wishing_, {});
  for (const std::uint32_t body : std::exchange(support_sleepers_, {})) some.push_back(body);
  some.insert(some.end(), changed_.begin(), changed_.end());
  changed_.clear();
  const bool all = std::exchange(look_at_all_, true);  // until the step has done what was decided
  if (all) {
    far_.clear();
    for (std::uint32_t body = 0; body < bodies.indices(); ++body) look_at(body, report);
    return;
  }
  if (!budgeted())  // before any are put in again
    while (far_.next_due() <= traveled_) far_.take_next(some);
  for (const FullLevel::Member& member : levels_.full.members()) some.push_back(member.owner);
  for (const BodyTable::Newcomer& newcomer : bodies.newcomers()) some.push_back(newcomer.index);
  if (levels_.statistical && sees_places()) {
    levels_.statistical->find_awake(some);
    for (const std::uint32_t body : levels_.statistical->fell_asleep()) some.push_back(body);
  }
  std::ranges::sort(some);  // sooner than the candidates, which are large
  for (const std::uint32_t body : some) look_at(body, report);
}

// Of the sleepers the nearest as well, until as many are known as may become full.
void Choose::look_at_nearest(StepReport& report) {
  std::vector<std::uint32_t> next;
  for (std::size_t known = candidates_.size();; known = candidates_.size()) {
    const double least = (far_.next_due() - traveled_) / levels_.bodies.greatest_importance();  // of those that are left
    if (far_.next_due() > 1e299 || reach_of_full(candidates_, viewpoints_, policy_, costs_->overhead(counts_)) < least) return;
    // Some more each time: what is known is ranked anew.
    while (candidates_.size() < known + known / 4 + 16 && far_.next_due() < 1e299) {
      next.clear();
      far_.take_next(next);
      for (const std::uint32_t body : next) look_at(body, report);
    }
  }
}

void Choose::look_at(std::uint32_t body, StepReport& report) {
  if (!levels_.bodies.alive(body)) return;
  BodyLevel& level = levels_.bodies.level(body);
  if (level.looked_at == report.step) return;
  const bool unseen = level.looked_at < report.step - 1;  // it slept
  level.looked_at = report.step;
  ++report.counters.levels_considered;
  if (level.rung == Rung::full || level.newcomer) note_waiting(body);
  if (!model_ && level.tables_open < 0 && open_to(level, false).has(Rung::tables)) ask_for_tables(body);
  const Activity does = budgeted() ? activity(levels_.bodies[body]) : Activity::alone;
  const RungSet open = open_to(level, does == Activity::asleep);
  if (does == Activity::asleep || unseen) level.woke_at = report.step;
  if (budgeted()) count(level.newcomer ? open.lowest() : level.rung, does, arrives(level, does), 1.0);
  const bool settled = open.one() && open.has(level.rung) && !level.newcomer && level.rung != Rung::full;
  if (settled && !budgeted()) {
    level.reason = LevelReason::forced;
    return;
  }
  LevelCandidate candidate = make_candidate(body, open, does == Activity::asleep);
  candidate.cost = cost_of_[std::size_t(does)];
  if (does == Activity::asleep && !open.has(Rung::tables)) candidate.cost[std::size_t(Rung::support)] = 0.0f;  // not all of them are looked at
  if (budgeted() && does == Activity::asleep && level.rung == Rung::support && open.has(Rung::tables)) support_sleepers_.push_back(body);
  if (budgeted() && arrives(level, does)) candidate.cost[std::size_t(level.rung)] += float(costs_->cost_of_arriving(level.rung));
  const auto* distance = std::get_if<DistancePolicy>(&policy_.policy);
  if (distance && !level.newcomer && policy_.most_full == kUnlimited && policy_.most_support == kUnlimited && stays_put(candidate, viewpoints_, *distance)) {
    level.reason = reason_for_rung(*distance, level.rung);
    put_far(body, candidate);
    return;
  }
  asked_.push_back(body);
  candidates_.push_back(candidate);
  activities_.push_back(does);
}

// One that sleeps at `tables` costs nothing there, and a budget has nothing to gain from moving it to `support`.
RungSet Choose::open_to(const BodyLevel& level, bool asleep) const {
  if (level.waits_for_signature || level.choice == LevelChoice::full) return {Rung::full};
  if (level.choice == LevelChoice::support) return {Rung::support};
  if (level.choice == LevelChoice::tables) return {Rung::tables};
  const auto* distance = std::get_if<DistancePolicy>(&policy_.policy);
  std::optional<Rung> fixed = model_ ? std::optional(rung_of(*model_)) : std::nullopt;
  if (!fixed && distance && distance->support_within == std::numeric_limits<double>::infinity()) fixed = Rung::support;
  if (!fixed && level.tables_open == 0) fixed = Rung::support;
  if (!fixed && budgeted() && asleep && !level.newcomer && level.rung == Rung::tables) fixed = Rung::tables;
  if (level.choice == LevelChoice::statistical) return fixed ? RungSet{*fixed} : RungSet{Rung::tables, Rung::support};
  return fixed ? RungSet{*fixed, Rung::full} : kEveryRung;
}

LevelCandidate Choose::make_candidate(std::uint32_t body, RungSet open, bool asleep) const {
  const BodyLevel& level = levels_.bodies.level(body);
  const BodyRecord& record = levels_.bodies[body];
  LevelCandidate candidate{.radius = levels_.bodies.shape(body)->radius,
                           .importance = level.importance,
                           .mesh = budgeted() ? mesh_weight(*levels_.bodies.shape(body)) : 0.0f,
                           .asleep = asleep,
                           .rung = level.rung,
                           .open = open,
                           .decided_by = level.waits_for_signature && level.choice != LevelChoice::full ? LevelReason::signature_pending : LevelReason::forced,
                           .newcomer = level.newcomer,
                           .put_off = level.put_off};
  candidate.frames_since_change = std::int32_t(std::min<std::int64_t>(levels_.now - level.changed_at, LevelCandidate{}.frames_since_change));
  if (record.statistical) candidate.position = levels_.statistical->position(record.statistical);  // all that it takes, of most bodies
  else candidate.position = levels_.state(body).position;
  if (budgeted() && record.ode && !asleep) candidate.motion = kFrame_s * levels_.full.world()->state(record.ode).velocity;
  const bool left_to_policy = level.choice == LevelChoice::automatic || (level.choice == LevelChoice::statistical && !model_);
  if (!static_bounds_.empty() && open.has(Rung::tables) && left_to_policy && !(asleep && open.one())) close_tables_near_static_ground(body, candidate);
  return candidate;
}

// Near enough to be there within three frames of a game. `support` meets static boxes and meshes by itself.
void Choose::close_tables_near_static_ground(std::uint32_t body, LevelCandidate& candidate) const {
  const double reach = 1.5 * candidate.radius + 0.05 * levels_.state(body).velocity.norm();
  const auto is_near = [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(candidate.position) < reach; };
  if (std::ranges::none_of(static_bounds_, is_near)) return;
  const bool full = candidate.open.has(Rung::full), support = !model_ || candidate.open.has(Rung::support);
  if (full && support) candidate.open = {Rung::support, Rung::full};
  else candidate.open = full ? RungSet{Rung::full} : RungSet{Rung::support};
  candidate.decided_by = LevelReason::static_ground;
}

Activity Choose::activity(const BodyRecord& record) const {
  if (record.statistical) return levels_.statistical->activity(record.statistical);
  if (!record.ode) return Activity::alone;
  if (levels_.full.world()->asleep(record.ode)) return Activity::asleep;
  return levels_.full.touches(record.ode) ? Activity::crowded : Activity::alone;
}

bool Choose::arrives(const BodyLevel& level, Activity does) const {
  return !level.newcomer && does == Activity::crowded && levels_.now - std::max(level.changed_at, level.woke_at) < kArrivalSteps;
}

void Choose::count_meetings() {
  counts_.rungs[std::size_t(Rung::full)][kOfFull] = levels_.full_pairs().awake;
  counts_.rungs[std::size_t(Rung::support)][kOfFull] = counts_.at(Rung::full, Activity::crowded);
}

void Choose::count(Rung rung, Activity does, bool arriving, double bodies) {
  counts_.at(rung, does) += bodies;
  if (arriving) counts_.rungs[std::size_t(rung)][kArriving] += bodies;
}

// A sleeper: where it is, and how far the viewpoints can travel before that matters.
void Choose::put_far(std::uint32_t body, const LevelCandidate& candidate) {
  const BodyRecord& record = levels_.bodies[body];
  if (viewpoints_.empty() || !record.statistical || !levels_.statistical->asleep(record.statistical)) return;
  double nearest = 1e300;
  for (const Vec3& viewpoint : viewpoints_) nearest = std::min(nearest, (candidate.position - viewpoint).norm());
  const auto* distance = std::get_if<DistancePolicy>(&policy_.policy);
  const double travel = distance ? travel_until_change(candidate, viewpoints_, *distance, policy_.hysteresis) : nearest - candidate.radius;
  if (travel < 1e299) far_.put(body, traveled_ + travel - kEarly * (1.0 + nearest));
}

// By index, on which the policy falls back among equals.
void Choose::put_in_order() {
  if (std::ranges::is_sorted(asked_)) return;
  std::vector<std::uint32_t> order(asked_.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [this](std::uint32_t i) { return asked_[i]; });
  std::vector<LevelCandidate> ordered(candidates_.size());
  std::vector<Activity> activities(activities_.size());
  for (std::size_t i = 0; i < order.size(); ++i) ordered[i] = candidates_[order[i]], activities[i] = activities_[order[i]];
  candidates_ = std::move(ordered);
  activities_ = std::move(activities);
  std::ranges::sort(asked_);
}

RungChanges Choose::take_answers(const LevelDecision& decision) {
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    const std::uint32_t body = asked_[i];
    const LevelReason reason = decision.reasons[i];
    levels_.bodies.level(body).reason = reason;
    if (levels_.bodies.level(body).newcomer) levels_.bodies.newcomer(body).rung = candidates_[i].decided() ? below_full(candidates_[i].open) : candidates_[i].open.lowest();
    if (waits(reason)) wishing_.push_back(body);
    else if (!candidates_[i].decided()) put_far(body, candidates_[i]);
  }
  RungChanges changes;
  for (const auto& [from, to] : {std::pair{&decision.promote, &changes.promote}, {&decision.demote, &changes.demote}})
    for (const LevelDecision::Change& change : *from) {
      const std::uint32_t body = asked_[std::size_t(change.candidate)];
      RungSet open = candidates_[std::size_t(change.candidate)].open;
      if (change.to == Rung::full) open = open_to(levels_.bodies.level(body), false);  // for one that is not let in, and sleeps
      const bool newcomer = levels_.bodies.level(body).newcomer;
      if (newcomer) levels_.bodies.newcomer(body).rung = change.to == Rung::full ? below_full(open) : change.to;
      if (!newcomer || change.to == Rung::full) to->push_back({body, change.to, open});
    }
  return changes;
}

// The highest rung that is open below full, or the manager's own where none is.
Rung Choose::below_full(RungSet open) const {
  const Rung rung = open.at_most(Rung::support);
  return rung != Rung::full ? rung : model_ ? rung_of(*model_) : Rung::support;
}

void Choose::count_changes(const RungChanges& changes) {
  for (const auto* list : {&changes.demote, &changes.promote})
    for (const RungChanges::Change& change : *list) {
      const auto i = std::size_t(std::ranges::lower_bound(asked_, change.body) - asked_.begin());
      count(candidates_[i].present(), activities_[i], arrives(levels_.bodies.level(change.body), activities_[i]), -1.0);
      count(change.to, activities_[i], activities_[i] == Activity::crowded && !candidates_[i].newcomer, 1.0);
      ++counts_.changes[std::size_t(change.to)];
    }
}

// `tables` needs a signature, and a source may have none.
void Choose::ask_for_tables(std::uint32_t body) {
  const BodyRecord& record = levels_.bodies[body];
  levels_.bodies.level(body).tables_open = levels_.signatures.find(*levels_.bodies.shape(body), levels_.ground_law(record.material)) != nullptr;
}

void Choose::note_waiting(std::uint32_t body) {
  BodyLevel& level = levels_.bodies.level(body);
  const MaterialId material = levels_.bodies[body].material;
  level.waits_for_signature = level.choice != LevelChoice::full && !levels_.signatures.ready(*levels_.bodies.shape(body), levels_.ground_law(material));
}

}  // namespace lodestone
