#include "lod/manager/choose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lod/manager/full_pairs.h"
#include "lod/manager/recorder.h"
#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

// m of travel, and over the distance: by so much a body's turn comes early, for rounding.
constexpr double kEarly = 1e-6;

// m of travel: then it is counted from zero again, lest it lose those few metres after which a body's turn
// comes.
constexpr double kLongTravel = 1e8;

/// m, of the one that came farthest; as many now as before.
double find_travel(const Views& before, const Views& now) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i)
    farthest = std::max(farthest, (now.position(i) - before.position(i)).norm());
  return farthest;
}

/// Whether the policy wanted another rung for it than it has.
bool waits(Rule reason) {
  return reason == Rule::dwell || reason == Rule::queued || reason == Rule::paused ||
         reason == Rule::overlap_put_off || reason == Rule::most_reached;
}

}  // namespace

void Choose::set_policy(const PolicySettings& policy) {
  policy_ = policy;
  limits_ = limits_of(policy);
  look_at_all_ = true;
  pause_ = {};
}

void Choose::set_views(Views views) {
  look_at_all_ |= views.size() != views_.size();
  turned_ |= look_at_all_ || views.turned_since(views_);
  if (!look_at_all_) traveled_ += find_travel(views_, views);
  if (!(traveled_ < kLongTravel))
    look_at_all_ = true, traveled_ = 0.0;  // whoever waits for a turn is looked at
  look_at_all_ |= turned_ && limits_ && limits_->measure == Measure::size && views.zoomed_since(views_);
  views_ = std::move(views);
}

std::optional<RungChanges> Choose::run(StepReport& report, CostModel& costs) {
  const StageTimer timer(report.times.choose_ms);
  costs_ = &costs;
  costs.set_unit(budgeted() && !counts_work(policy_) ? CostModel::Unit::milliseconds : CostModel::Unit::work);
  look_at_those_concerned(report);
  if (budgeted() && !by_error() && !views_.empty()) look_at_nearest(report);
  turned_ = false;
  counts_.asked = int(asked_.size());
  predicted_error_ = 0.0;
  if (asked_.empty()) {
    look_at_all_ = false;
    return {};
  }
  put_in_order();
  if (policy_.look_ahead_s > 0.0) look_ahead();
  RungChanges changes = take_answers(decide());
  if (budgeted()) count_changes(changes);
  if (by_error()) add_up_errors(changes);
  return changes;
}

// Where a budget is to be kept, what is awake costs something, seen or not.
bool Choose::sees_places() const {
  if (budgeted()) return true;
  const BodyTable& bodies = levels_.bodies;
  return !views_.empty() &&
         bodies.count(LevelChoice::automatic) + (model_ ? 0 : bodies.count(LevelChoice::statistical)) > 0;
}

void Choose::look_at_those_concerned(StepReport& report) {
  asked_.clear();
  candidates_.clear();
  activities_.clear();
  counts_ = {};
  full_in_crowd_ = 0.0;
  counts_.added = int(levels_.bodies.newcomers().size());
  BodyTable& bodies = levels_.bodies;
  concerned_.clear();
  for (std::vector<std::uint32_t>* noted : {&wishing_, &support_sleepers_, &changed_}) {
    concerned_.insert(concerned_.end(), noted->begin(), noted->end());
    noted->clear();
  }
  const bool all = std::exchange(look_at_all_, true);  // until the step has done what was decided
  if (all) {
    far_.clear();
    seen_or_not_.clear();
    for (std::uint32_t body = 0; body < bodies.indices(); ++body) look_at(body, report);
    return;
  }
  if (turned_ || policy_.visible) {
    concerned_.insert(concerned_.end(), seen_or_not_.begin(), seen_or_not_.end());
    seen_or_not_.clear();
  }
  if (!budgeted())  // before any are put in again
    while (far_.next_due() <= traveled_) far_.take_next(concerned_);
  for (const FullLevel::Member& member : levels_.full.members()) concerned_.push_back(member.owner);
  for (const BodyTable::Newcomer& newcomer : bodies.newcomers()) concerned_.push_back(newcomer.index);
  if (levels_.statistical && sees_places()) {
    levels_.statistical->find_awake(concerned_);
    for (const std::uint32_t body : levels_.statistical->fell_asleep()) concerned_.push_back(body);
  }
  std::ranges::sort(concerned_);  // sooner than the candidates, which are large
  for (const std::uint32_t body : concerned_) look_at(body, report);
}

// Of the sleepers the nearest as well, until as many are known as may become full.
void Choose::look_at_nearest(StepReport& report) {
  constexpr std::size_t kFirst = 16;
  std::vector<std::uint32_t>& next = concerned_;  // who have been looked at
  const std::size_t before = candidates_.size();
  for (;;) {
    const double least =
        (far_.next_due() - traveled_) / levels_.bodies.greatest_importance();  // of those that are left
    counts_.asked = int(asked_.size());
    if (far_.next_due() > 1e299 ||
        reach_of_full(make_units(), views_, policy_, costs_->overhead(counts_)) < least)
      return;
    // Twice as many each time, as what is known is ranked anew.
    const std::size_t enough = before + kFirst + 2 * (candidates_.size() - before);
    while (candidates_.size() < enough && far_.next_due() < 1e299) {
      next.clear();
      const double due_before = far_.take_next(next);
      for (const std::uint32_t body : next)
        if (const double due = due_asleep(body); due < due_before)
          look_at(body, report);
        else
          far_.put(body, due);
    }
  }
}

// m of travel, as of put_far(), from where the viewpoints are now: after they have jumped, most of those that
// seem to be due are far again. At once for all but single sleepers.
double Choose::due_asleep(std::uint32_t body) const {
  const BodyTable& bodies = levels_.bodies;
  const bool sleeps =
      bodies.alive(body) && bodies[body].statistical && levels_.statistical->asleep(bodies[body].statistical);
  if (!sleeps || groups_.of(body)) return -1e300;
  const double nearest = distance_to_views(levels_.state(body).position);
  return traveled_ + nearest - bodies.shape(body)->radius - kEarly * (1.0 + nearest);
}

double Choose::distance_to_views(const Vec3& position) const {
  double nearest = 1e300;
  for (std::size_t view = 0; view < views_.size(); ++view)
    nearest = std::min(nearest, (position - views_.position(view)).norm());
  return nearest;
}

// Asks the policy about a body, unless its answer is known.
void Choose::look_at(std::uint32_t body, StepReport& report) {
  if (!levels_.bodies.alive(body)) return;
  BodyLevel& level = levels_.bodies.level(body);
  if (level.looked_at == report.step) return;
  const bool unseen = level.looked_at < report.step - 1;  // it slept
  level.looked_at = report.step;
  ++report.counters.levels_considered;
  const bool grouped = bool(groups_.of(body));
  if (grouped)
    for (const std::uint32_t member : groups_.members(groups_.of(body))) look_at(member, report);
  ask_for_signature(body, level);
  const Circumstances is = find_circumstances(body, level);
  if (is.asleep() || unseen) level.woke_at = report.step;
  if (budgeted()) count_present(level, is);
  const bool settled =
      is.open.one() && is.open.has(level.rung) && !level.newcomer && level.rung != Rung::full;
  if (settled && !budgeted() && !grouped) {
    level.reason = rule_for_one(level);
    return;
  }
  LevelCandidate candidate = make_candidate(body, is.open, is.asleep());
  if (is.pinned) candidate.decided_by = Rule::joined;
  if (is.carries) candidate.decided_by = Rule::carries_full;
  price(body, level, is, candidate);
  if (!grouped && stays_as_it_is(level, candidate)) {
    level.reason = reason_for_rung(*limits_, candidate);
    put_far(body, candidate);
    return;
  }
  asked_.push_back(body);
  candidates_.push_back(candidate);
  activities_.push_back(is.does);
}

// What a body has of signatures goes with it from one statistical rung to the other; a step waits for no
// other.
void Choose::ask_for_signature(std::uint32_t body, const BodyLevel& level) {
  const bool may_be_at_tables = open_to(level, false).has(Rung::tables);
  const bool may_need_signature = may_be_at_tables && !levels_.own_signature(body);
  if (level.rung == Rung::full || level.newcomer || may_need_signature) note_waiting(body);
  if (!model_ && level.tables_open < 0 && !level.waits_for_signature && may_be_at_tables)
    ask_for_tables(body);
}

Choose::Circumstances Choose::find_circumstances(std::uint32_t body, const BodyLevel& level) {
  Circumstances is;
  is.does = budgeted() || policy_.contact_groups_together ? activity(body) : Activity::alone;
  is.pinned = level.rung == Rung::full && !level.newcomer && groups_.pinned(body);
  is.held = is.pinned && !is.asleep();
  is.open = open_to(level, is.asleep());
  is.carries =
      level.own_properties && !groups_.of(body) && is.open.has(Rung::full) && carriers_.contains(body);
  if (is.pinned || is.carries) is.open = RungSet{Rung::full};
  is.mesh = budgeted() ? mesh_weight(*levels_.bodies.shape(body)) : 0.0f;
  return is;
}

// On the rung that it has before the decision.
void Choose::count_present(const BodyLevel& level, const Circumstances& is) {
  if (is.held)
    count_held(is.does, costs_->full_share(is.mesh));
  else
    count(level.newcomer ? is.open.lowest() : level.rung, is.does, arrives(level, is.does), is.mesh, 1.0);
}

// What the candidate costs on each rung, and by how much it is wrong there, as far as the policy asks.
void Choose::price(std::uint32_t body, const BodyLevel& level, const Circumstances& is,
                   LevelCandidate& candidate) {
  candidate.mesh = is.mesh;
  // A sleeper keeps its rung by what it would save awake: in turn with those around it, that would wake each
  // other as they go up and down.
  const bool keeps = by_error() && is.asleep() && candidate.present() > is.open.lowest();
  if (by_error()) predict_errors(body, keeps ? Activity::crowded : is.does, candidate);
  if (budgeted()) candidate.cost = costs_->cost_of(is.does, costs_->full_share(is.mesh));
  if (budgeted() && is.open.one() && is.open.has(Rung::full) && !level.newcomer)
    candidate.cost[std::size_t(Rung::full)] =
        float(costs_->cost_of_forced_full(is.does, is.held, costs_->full_share(is.mesh)));
  if (is.asleep() && !is.open.has(Rung::tables))
    candidate.cost[std::size_t(Rung::support)] = 0.0f;  // not all of them are looked at
  if (budgeted() && is.asleep() && level.rung == Rung::support && is.open.has(Rung::tables))
    support_sleepers_.push_back(body);
  const auto at = std::size_t(level.rung);
  if (keeps)
    candidate.passing =
        candidate.cost[at] - costs_->cost_of(Activity::crowded, costs_->full_share(is.mesh))[at];
  if (budgeted() && !is.held && arrives(level, is.does)) {
    candidate.passing = float(costs_->cost_of_arriving(level.rung) *
                              (level.rung == Rung::full ? costs_->full_share(is.mesh) : 1.0));
    candidate.cost[at] += candidate.passing;
  }
}

// Whether a policy of distances or sizes surely leaves it where it is, so that it need not be asked.
bool Choose::stays_as_it_is(const BodyLevel& level, const LevelCandidate& candidate) const {
  const bool limited = policy_.most_full < kUnlimited || policy_.most_support < kUnlimited;
  const bool may_hit = candidate.ahead.squaredNorm() > candidate.radius * candidate.radius;
  return limits_ && !level.newcomer && !limited && !may_hit && !policy_.contact_groups_together &&
         stays_put(candidate, views_, *limits_);
}

bool Choose::arrives(const BodyLevel& level, Activity does) const {
  return !level.newcomer && does == Activity::crowded &&
         levels_.now - std::max(level.changed_at, level.woke_at) < kArrivalSteps;
}

void Choose::count_meetings() {
  counts_.rungs[std::size_t(Rung::full)][kOfFull] = awake_pairs();
  counts_.rungs[std::size_t(Rung::support)][kOfFull] = full_in_crowd_;
}

// Within a group that joints hold most are too near each other to be a pair: they cost what the joints do.
double Choose::awake_pairs() const {
  const std::span<const FullLevel::Member> members = levels_.full.members();
  double most_radius = 0.0, awake = 0.0;
  for (const FullLevel::Member& member : members)
    most_radius = std::max(most_radius, levels_.bodies.shape(member.owner)->radius);
  FullPairs pairs(most_radius);
  for (const FullLevel::Member& member : members) {
    const Shape& shape = *levels_.bodies.shape(member.owner);
    const OdeWorld& world = *levels_.full.world();
    FullPairs::Body body{world.state(member.id).position, shape.radius, mesh_weight(shape),
                         world.asleep(member.id)};
    if (groups_.of(member.owner) && groups_.joined(member.owner))
      body.joined = groups_.of(member.owner).index;
    awake += pairs.meet(body).awake;
    pairs.add(body);
  }
  return awake;
}

void Choose::count_held(Activity does, double share) {
  counts_.rungs[std::size_t(Rung::full)][kJoined] += share;
  full_in_crowd_ += does == Activity::crowded;
}

void Choose::count(Rung rung, Activity does, bool arriving, float mesh, double bodies) {
  if (rung == Rung::full && does == Activity::crowded) full_in_crowd_ += bodies;
  if (rung == Rung::full) bodies *= costs_->full_share(mesh);
  counts_.at(rung, does) += bodies;
  if (arriving) counts_.rungs[std::size_t(rung)][kArriving] += bodies;
}

// A sleeper: where it is, and how far the viewpoints can travel before that matters.
void Choose::put_far(std::uint32_t body, const LevelCandidate& candidate) {
  const BodyRecord& record = levels_.bodies[body];
  if (views_.empty() || !record.statistical || !levels_.statistical->asleep(record.statistical)) return;
  const double nearest = distance_to_views(candidate.position);
  double travel = limits_ ? travel_until_change(candidate, views_, *limits_, policy_.hysteresis)
                          : nearest - candidate.radius;
  if (limits_ && policy_.out_of_view_factor > 1.0) {
    // What the policy would want of it, were it in view, or not.
    LevelCandidate otherwise = candidate;
    otherwise.view_factor = candidate.view_factor > 1.0 ? 1.0 : policy_.out_of_view_factor;
    const double other_travel = travel_until_change(otherwise, views_, *limits_, policy_.hysteresis);
    if (other_travel <= 0.0)
      seen_or_not_.push_back(body);
    else
      travel = std::min(travel, other_travel);
  }
  if (travel < 1e299) far_.put(body, traveled_ + travel - kEarly * (1.0 + nearest));
}

// By index, on which the policy falls back among equals.
void Choose::put_in_order() {
  if (std::ranges::is_sorted(asked_)) return;
  order_.resize(asked_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [this](std::uint32_t i) { return asked_[i]; });
  ordered_.clear(), activities_in_order_.clear();
  for (const std::uint32_t i : order_) {
    ordered_.push_back(candidates_[i]);
    activities_in_order_.push_back(activities_[i]);
  }
  std::swap(candidates_, ordered_);
  std::swap(activities_, activities_in_order_);
  std::ranges::sort(asked_);
}

RungChanges Choose::take_answers(const LevelDecision& decision) {
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    const std::uint32_t body = asked_[i];
    const Rule reason = decision.reasons[i];
    levels_.bodies.level(body).reason = reason;
    if (levels_.bodies.level(body).newcomer)
      levels_.bodies.newcomer(body).rung =
          candidates_[i].decided() ? below_full(candidates_[i].open) : candidates_[i].open.lowest();
    if (waits(reason))
      wishing_.push_back(body);
    else if (!candidates_[i].decided())
      put_far(body, unit_of_.empty() ? candidates_[i] : units_[std::size_t(unit_of_[i])]);
  }
  RungChanges changes;
  for (const auto& [from, to] :
       {std::pair{&decision.promote, &changes.promote}, {&decision.demote, &changes.demote}})
    for (const LevelDecision::Change& change : *from) {
      const std::uint32_t body = asked_[std::size_t(change.candidate)];
      RungSet open = candidates_[std::size_t(change.candidate)].open;
      const std::int32_t unit = unit_of_.empty() ? -1 : unit_of_[std::size_t(change.candidate)],
                         together = unit >= 0 && units_[std::size_t(unit)].bodies > 1 ? unit : -1;
      if (change.to == Rung::full && together < 0)
        open = open_to(levels_.bodies.level(body), false);  // for one that is not let in, and sleeps
      const bool newcomer = levels_.bodies.level(body).newcomer;
      if (newcomer)
        levels_.bodies.newcomer(body).rung = change.to == Rung::full ? below_full(open) : change.to;
      if (!newcomer || change.to == Rung::full) to->push_back({body, change.to, open, together});
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
      count(candidates_[i].present(), activities_[i],
            arrives(levels_.bodies.level(change.body), activities_[i]), candidates_[i].mesh, -1.0);
      count(change.to, activities_[i], activities_[i] == Activity::crowded && !candidates_[i].newcomer,
            candidates_[i].mesh, 1.0);
      ++counts_.changes[std::size_t(change.to)];
    }
}

void Choose::add_up_errors(const RungChanges& changes) {
  const auto add = [&](std::size_t i, Rung rung, double sign) {
    predicted_error_ += candidates_[i].asleep ? 0.0 : sign * candidates_[i].error_at(rung);
  };
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    add(i, candidates_[i].newcomer ? levels_.bodies.newcomer(asked_[i]).rung : candidates_[i].rung, 1.0);
  for (const auto* list : {&changes.demote, &changes.promote})
    for (const RungChanges::Change& change : *list) {
      const auto i = std::size_t(std::ranges::lower_bound(asked_, change.body) - asked_.begin());
      add(i, candidates_[i].newcomer ? levels_.bodies.newcomer(change.body).rung : candidates_[i].rung, -1.0);
      add(i, change.to, 1.0);
    }
}

void Choose::archive(StateArchive& a) {
  StateArchive own;
  RecordedPolicy policy{policy_, bool(policy_.visible), bool(policy_.significance)};
  own(policy);
  std::vector<std::byte> written = own.bytes();
  a(written, groups_, carriers_, views_, turned_, look_at_all_, wishing_, changed_, support_sleepers_,
    seen_or_not_, waiting_, next_waiting_, far_, traveled_, pause_, counts_);
  if (a.reading()) look_at_all_ |= written != own.bytes();
}

}  // namespace lodestone
