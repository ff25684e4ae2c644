// Bodies that change rung together stand before the policy as one: as near as the nearest of them, at the
// cost of all.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "lod/manager/choose.h"

namespace lodestone {
namespace {

// A heap of more bodies in contact than this is no group: it would be full as a whole, or not at all.
constexpr int kMostInContact = 32;

/// Which candidates belong together.
class Units {
 public:
  explicit Units(std::size_t candidates) : parent_(candidates), size_(candidates, 1) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }
  void join(std::int32_t a, std::int32_t b, int most) {
    a = root(a), b = root(b);
    if (a == b || size_[std::size_t(a)] + size_[std::size_t(b)] > most) return;
    if (a > b) std::swap(a, b);
    parent_[std::size_t(b)] = a, size_[std::size_t(a)] += size_[std::size_t(b)];
  }

 private:
  std::vector<std::int32_t> parent_;
  std::vector<int> size_;
};

void join_groups(const Groups& groups, std::span<const std::uint32_t> bodies, Units& units) {
  std::unordered_map<std::uint32_t, std::int32_t> first;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (const GroupId group = groups.of(bodies[i]))
      units.join(first.try_emplace(group.index, std::int32_t(i)).first->second, std::int32_t(i), INT32_MAX);
}

/// Of bodies that touch something: whose bounding spheres meet. First those on one rung, so that of a heap of
/// more than a group holds the same are together in the next step.
void join_touching(std::span<const LevelCandidate> candidates, std::span<const Activity> activities,
                   Units& units) {
  double reach = 0.0;
  std::vector<std::int32_t> crowd;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (activities[i] == Activity::crowded)
      crowd.push_back(std::int32_t(i)), reach = std::max(reach, candidates[i].radius);
  const auto at = [&](std::int32_t i) -> const LevelCandidate& { return candidates[std::size_t(i)]; };
  std::ranges::sort(crowd, {}, [&](std::int32_t i) { return std::pair(at(i).position.x(), i); });
  std::vector<std::pair<std::int32_t, std::int32_t>> across;  // rungs
  for (std::size_t a = 0; a < crowd.size(); ++a)
    for (std::size_t b = a + 1; b < crowd.size() && at(crowd[b]).position.x() - at(crowd[a]).position.x() <=
                                                        at(crowd[a]).radius + reach;
         ++b) {
      const double touch = at(crowd[a]).radius + at(crowd[b]).radius;
      if ((at(crowd[b]).position - at(crowd[a]).position).squaredNorm() > touch * touch) continue;
      if (at(crowd[a]).rung == at(crowd[b]).rung)
        units.join(crowd[a], crowd[b], kMostInContact);
      else
        across.emplace_back(crowd[a], crowd[b]);
    }
  for (const auto& [a, b] : across) units.join(a, b, kMostInContact);
}

void add(const LevelCandidate& member, const Views& views, Measure measure, LevelCandidate& unit) {
  // Where it is: the nearest's.
  if (remoteness(member, views, measure) < remoteness(unit, views, measure)) {
    unit.position = member.position, unit.radius = member.radius, unit.importance = member.importance,
    unit.view_factor = member.view_factor;
    unit.ahead = member.ahead, unit.no_farther_than = member.no_farther_than, unit.motion = member.motion;
  }
  for (std::size_t rung = 0; rung < kRungs; ++rung)
    unit.cost[rung] += member.cost[rung], unit.error[rung] += member.error[rung];
  unit.passing += member.passing;
  unit.mesh = std::max(unit.mesh, member.mesh);  // one of them meets what is outside
  unit.asleep &= member.asleep;
  unit.dwell_left = std::max(unit.dwell_left, member.dwell_left);
  if (unit.newcomer == member.newcomer)
    unit.rung = std::max(unit.rung, member.rung);
  else if (unit.newcomer)
    unit.rung = member.rung;
  unit.newcomer &= member.newcomer;
  if (member.decided() && !unit.decided()) unit.decided_by = member.decided_by;
  unit.open = unit.open.together_with(member.open);
  unit.put_off |= member.put_off;
  unit.hits_full |= member.hits_full;
  ++unit.bodies;
}

}  // namespace

std::span<const LevelCandidate> Choose::make_units() {
  unit_of_.clear();
  if (groups_.empty() && !policy_.contact_groups_together) return candidates_;
  Units units(candidates_.size());
  join_groups(groups_, asked_, units);
  if (policy_.contact_groups_together) join_touching(candidates_, activities_, units);
  units_.clear();
  unit_of_.assign(candidates_.size(), -1);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const auto root = std::size_t(units.root(std::int32_t(i)));  // no later than its members
    unit_of_[i] = root == i ? std::int32_t(units_.size()) : unit_of_[root];
    if (root == i)
      units_.push_back(candidates_[i]);
    else
      add(candidates_[i], views_, limits_ ? limits_->measure : Measure::distance,
          units_[std::size_t(unit_of_[i])]);
  }
  if (budgeted()) count_pairs_within();
  return units_;
}

// Joints hold most of their bodies too near each other to be a pair.
void Choose::count_pairs_within() {
  std::vector<std::vector<std::size_t>> members(units_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (LevelCandidate& unit = units_[std::size_t(unit_of_[i])];
        unit.bodies > 1 && unit.decided_by != Rule::joined)
      members[std::size_t(unit_of_[i])].push_back(i);
  for (std::size_t unit = 0; unit < units_.size(); ++unit) {
    double most_radius = 0.0;
    for (const std::size_t i : members[unit]) most_radius = std::max(most_radius, candidates_[i].radius);
    if (members[unit].empty()) continue;
    FullPairs pairs(most_radius);
    for (const std::size_t i : members[unit]) {
      const LevelCandidate& c = candidates_[i];
      const FullPairs::Body body{c.position, c.radius, c.mesh, c.asleep, c.motion};
      units_[unit].pairs_within += pairs.meet(body);
      pairs.add(body);
    }
  }
}

// Whether so many sleep that the others may do so if only they are left alone.
bool Choose::comes_to_rest() const {
  constexpr int kAThird = 3;
  const int asleep =
      levels_.full.asleep_count() + (levels_.statistical ? levels_.statistical->asleep_count() : 0);
  return kAThird * asleep > levels_.bodies.size();
}

LevelDecision Choose::decide() {
  StepOverhead overhead = costs_->overhead(counts_);
  overhead.pauses = pause_.holds() && comes_to_rest();
  const LevelDecision decision = choose_levels(make_units(), views_, policy_, overhead);
  pause_.note(decision.sent_back > 0, traveled_);
  return unit_of_.empty() ? decision : tell_members(decision);
}

// A member that is not where the others are, since it has just come to them, follows in any case, as far as
// its own level, range and properties let it.
LevelDecision Choose::tell_members(const LevelDecision& of_units) {
  std::vector<std::vector<std::int32_t>> members(units_.size());
  LevelDecision decision;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const auto unit = std::size_t(unit_of_[i]);
    members[unit].push_back(std::int32_t(i));
    decision.reasons.push_back(of_units.reasons[unit]);
    if (units_[unit].bodies > 1)
      candidates_[i].open = units_[unit].open.within(candidates_[i].open),
      candidates_[i].decided_by = units_[unit].decided_by;
  }
  std::vector<bool> told(units_.size(), false);
  const auto tell = [&](std::size_t unit, Rung to_all) {
    told[unit] = true;
    for (const std::int32_t i : members[unit]) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      const Rung to = c.open.at_most(to_all);
      if (c.newcomer ? to > c.open.lowest() || c.decided() : to > c.rung)
        decision.promote.push_back({i, to});
      else if (!c.newcomer && to < c.rung)
        decision.demote.push_back({i, to});
    }
  };
  for (const auto* changes : {&of_units.demote, &of_units.promote})
    for (const LevelDecision::Change& change : *changes) tell(std::size_t(change.candidate), change.to);
  for (std::size_t unit = 0; unit < units_.size(); ++unit)
    if (!told[unit] && units_[unit].bodies > 1 && !units_[unit].newcomer) tell(unit, units_[unit].rung);
  return decision;
}

}  // namespace lodestone
