// Each policy says what rung it wants for every body; what dwell, queue, caps and room then allow is the same for all.
#include "lod/manager/choose_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max() / 2;

// Of the room above what the lowest rungs cost, the part that full bodies leave to a ring of `support` around them: what goes up from `tables` takes it first.
constexpr double kShareOfRing = 0.25;

/// What the policy itself wants of one body.
struct Target {
  Rung rung = Rung::support;
  LevelReason reason = LevelReason::far;
  bool at_once = false;  // neither dwell nor cap may hold it up
};

/// A body by its distance, or by its rank among the others; ties go to the lower index, so that the order is the same in every run.
struct Ranked {
  double distance = 0.0;
  std::int32_t index = 0;
  Rung to = Rung::support;
};
bool nearer(const Ranked& a, const Ranked& b) { return a.distance != b.distance ? a.distance < b.distance : a.index < b.index; }
bool farther(const Ranked& a, const Ranked& b) { return a.distance != b.distance ? a.distance > b.distance : a.index < b.index; }

double squared_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints) {
  double nearest = kInfinity;
  for (const Vec3& viewpoint : viewpoints) nearest = std::min(nearest, (candidate.position - viewpoint).squaredNorm());
  return nearest;
}

double scaled_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints) {
  return std::max(0.0, std::sqrt(squared_distance(candidate, viewpoints)) - candidate.radius) / candidate.importance;
}

Target target_by_distance(const LevelCandidate& c, double distance, const DistancePolicy& policy, double hysteresis) {
  const auto at = [&](Rung rung, LevelReason reason) { return Target{c.open.at_most(rung), reason}; };
  if (distance <= policy.full_within) return at(Rung::full, LevelReason::near);
  if (c.present() == Rung::full && distance <= policy.full_within * (1.0 + hysteresis)) return at(Rung::full, LevelReason::within_hysteresis);
  if (distance <= policy.support_within) return at(Rung::support, reason_for_rung(policy, Rung::support));
  if (c.present() != Rung::tables && distance <= policy.support_within * (1.0 + hysteresis)) return at(Rung::support, LevelReason::within_hysteresis);
  return at(Rung::tables, LevelReason::far);
}

/// What a budget leaves, in its unit: above what all cost on their lowest rungs.
struct BudgetRoom {
  double keep = 0.0, grow = 0.0;  // for those that are on a higher rung; for more of them
  double full_now = 0.0;          // taken up by those that are full
  bool over = false;
};

double raise(const LevelCandidate& c, Rung to) { return c.cost_at(to) - c.cost_at(c.open.lowest()); }

// The number on a higher rung grows while part of the budget is free, and shrinks when all of it is used up.
BudgetRoom find_room(std::span<const LevelCandidate> candidates, double budget, double hysteresis, const StepOverhead& overhead) {
  BudgetRoom room;
  double lowest = overhead.others, now = overhead.others;
  for (const LevelCandidate& c : candidates) {
    lowest += c.cost_at(c.open.lowest());
    now += c.cost_at(c.decided() ? c.open.lowest() : c.present());
    if (!c.decided() && c.present() == Rung::full) room.full_now += raise(c, Rung::full);
  }
  const double usable = budget / (1.0 + overhead.margin);
  room.keep = std::max(0.0, usable - lowest);
  room.grow = std::max(0.0, usable / (1.0 + hysteresis) - lowest);
  room.over = now > usable;
  return room;
}

double budget_of(const PolicySettings& settings) {
  if (const auto* timed = std::get_if<BudgetPolicy>(&settings.policy)) return timed->budget_ms;
  return std::get<WorkPolicy>(settings.policy).budget_work;
}

/// Moves the nearest to the front, as many as there is room for and no more than `most`, and returns how many they are. Halves in place of a sort.
template <class Cost>
std::size_t take_nearest(std::span<Ranked> ranked, double room, std::int64_t most, const Cost& cost) {
  std::size_t begin = 0, end = ranked.size();
  while (end - begin > 16) {
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(ranked.begin() + std::ptrdiff_t(begin), ranked.begin() + std::ptrdiff_t(middle), ranked.begin() + std::ptrdiff_t(end), nearer);
    double taken = 0.0;
    for (std::size_t i = begin; i < middle; ++i) taken += cost(ranked[i].index);
    if (taken > room || std::int64_t(middle) > most) {
      end = middle;
    } else {
      room -= taken;
      begin = middle;
    }
  }
  std::sort(ranked.begin() + std::ptrdiff_t(begin), ranked.begin() + std::ptrdiff_t(end), nearer);
  for (; begin < end && std::int64_t(begin) < most; ++begin)
    if ((room -= cost(ranked[begin].index)) < 0.0) break;
  return begin;
}

/// The room that full bodies have: whoever of the three rungs may be asked leaves some to the ring.
double room_of_full(const BudgetRoom& room, bool ring) {
  const double share = ring ? 1.0 - kShareOfRing : 1.0;
  return std::min(share * room.keep, std::max(room.full_now, share * room.grow));
}

bool can_be_in_ring(const LevelCandidate& c) { return !c.decided() && c.open.has(Rung::tables) && c.open.has(Rung::support); }

class Chooser {
 public:
  Chooser(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead)
      : candidates_(candidates), viewpoints_(viewpoints), settings_(settings), overhead_(overhead) {
    decision_.reasons.resize(candidates.size());
  }

  LevelDecision by(const DistancePolicy& policy) {
    const bool limited = settings_.most_full < kUnlimited || settings_.most_support < kUnlimited;
    std::vector<Ranked> ranked;
    std::vector<Target> targets;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (!limited && !c.newcomer && stays_put(c, viewpoints_, policy)) {
        decision_.reasons[std::size_t(i)] = reason_for_rung(policy, c.rung);
        continue;
      }
      const double distance = scaled_distance(c, viewpoints_);
      ranked.push_back({distance, i});
      targets.push_back(c.decided() ? Target{} : target_by_distance(c, distance, policy, settings_.hysteresis));
    }
    if (limited) limit(ranked, targets);
    for (std::size_t k = 0; k < ranked.size(); ++k) consider(ranked[k], targets[k]);
    grant();
    return std::move(decision_);
  }

  LevelDecision by_budget(double budget) {
    const BudgetRoom room = find_room(candidates_, budget, settings_.hysteresis, overhead_);
    room_ = budget / (1.0 + overhead_.margin) - overhead_.others;
    std::vector<Ranked> ranked;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      room_ -= c.cost_at(c.decided() ? c.open.lowest() : c.present());
      if (c.decided()) consider({0.0, i}, {});
      else ranked.push_back({rank_distance(c, viewpoints_, settings_.hysteresis), i});
    }
    share_out(room, ranked);
    count_limits();
    grant();
    return std::move(decision_);
  }

  /// The rank distance of the nearest that finds no room to be full.
  double reach(double budget) const {
    if (viewpoints_.empty()) return 0.0;
    std::vector<Ranked> ranked;
    bool ring = false;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      ring |= can_be_in_ring(c);
      if (!c.decided() && c.open.has(Rung::full)) ranked.push_back({rank_distance(c, viewpoints_, settings_.hysteresis), i});
    }
    const double room = room_of_full(find_room(candidates_, budget, settings_.hysteresis, overhead_), ring);
    const std::size_t taken = take_full(ranked, room);
    if (taken == ranked.size()) return std::int64_t(taken) < settings_.most_full ? kInfinity : 0.0;
    return std::min_element(ranked.begin() + std::ptrdiff_t(taken), ranked.end(), nearer)->distance;
  }

 private:
  std::int32_t count() const { return std::int32_t(candidates_.size()); }
  const LevelCandidate& candidate(const Ranked& r) const { return candidates_[std::size_t(r.index)]; }

  std::size_t take_full(std::span<Ranked> ranked, double room) const {
    return take_nearest(ranked, room, settings_.most_full, [this](std::int32_t i) { return raise(candidates_[std::size_t(i)], Rung::full); });
  }

  /// The nearest full, as many as there is room for, the next `support`, the rest on their lowest rungs.
  void share_out(const BudgetRoom& room, std::span<Ranked> ranked) {
    const bool ring = std::ranges::any_of(ranked, [this](const Ranked& r) { return can_be_in_ring(candidate(r)); });
    const std::span<Ranked> never_full(std::ranges::partition(ranked, [this](const Ranked& r) { return candidate(r).open.has(Rung::full); }));
    const std::span<Ranked> may_be_full = ranked.first(ranked.size() - never_full.size());
    const std::size_t full = viewpoints_.empty() ? 0 : take_full(may_be_full, room_of_full(room, ring));
    const bool most_full = full < may_be_full.size() && std::int64_t(full) == settings_.most_full;
    double used = 0.0;
    for (const Ranked& r : ranked.first(full)) {
      used += raise(candidate(r), Rung::full);
      consider(r, {Rung::full, LevelReason::in_budget});
    }
    const std::span<Ranked> rest = ranked.subspan(full);
    const std::span<Ranked> lowest(std::ranges::partition(rest, [this](const Ranked& r) { return can_be_in_ring(candidate(r)); }));
    const std::span<Ranked> may_be_in_ring = rest.first(rest.size() - lowest.size());
    double ring_now = 0.0;
    for (const Ranked& r : may_be_in_ring)
      if (candidate(r).present() != Rung::tables) ring_now += raise(candidate(r), Rung::support);
    const double room_of_ring = std::min(room.keep - used, std::max(ring_now, room.grow - used));
    const std::size_t support = take_nearest(may_be_in_ring, room_of_ring, settings_.most_support, [this](std::int32_t i) { return raise(candidates_[std::size_t(i)], Rung::support); });
    const bool most_support = support < may_be_in_ring.size() && std::int64_t(support) == settings_.most_support;
    for (const Ranked& r : may_be_in_ring.first(support)) consider(r, {Rung::support, LevelReason::in_budget, room.over});
    const LevelReason reason = viewpoints_.empty() ? LevelReason::far : LevelReason::over_budget;
    for (const Ranked& r : rest.subspan(support)) {
      const bool limited = can_be_in_ring(candidate(r)) ? most_support : most_full;
      consider(r, {candidate(r).open.lowest(), limited ? LevelReason::most_reached : reason, room.over});
    }
  }

  /// Sends the farthest of those that are wanted on a rung down where they would be more than `most`.
  void limit(std::span<const Ranked> ranked, std::span<Target> targets) {
    for (const auto& [rung, most] : {std::pair{Rung::full, settings_.most_full}, {Rung::support, settings_.most_support}}) {
      std::vector<Ranked> wanted;
      std::int64_t there = 0;
      for (std::size_t k = 0; k < ranked.size(); ++k) {
        const LevelCandidate& c = candidate(ranked[k]);
        if (c.decided()) continue;
        there += !c.newcomer && c.rung == rung;
        if (targets[k].rung == rung && c.open.lowest() < rung) wanted.push_back({rank_distance(c, viewpoints_, settings_.hysteresis), std::int32_t(k)});
      }
      if (std::int64_t(wanted.size()) <= most) continue;
      std::ranges::nth_element(wanted, wanted.begin() + most, nearer);
      for (auto w = wanted.begin() + most; w != wanted.end(); ++w)
        targets[std::size_t(w->index)] = {candidate(ranked[std::size_t(w->index)]).open.at_most(Rung(int(rung) - 1)), LevelReason::most_reached, there > most};
    }
    count_limits();
  }

  /// How many more the policy may put on each rung.
  void count_limits() {
    places_[std::size_t(Rung::full)] = settings_.most_full < kUnlimited ? settings_.most_full : kNoLimit;
    places_[std::size_t(Rung::support)] = settings_.most_support < kUnlimited ? settings_.most_support : kNoLimit;
    for (const LevelCandidate& c : candidates_)
      if (!c.decided() && !c.newcomer) --places_[std::size_t(c.rung)];
  }

  /// Notes why a body has its rung, and its wish for a change.
  void consider(const Ranked& by_distance, Target target) {
    const LevelCandidate& c = candidate(by_distance);
    LevelReason& reason = decision_.reasons[std::size_t(by_distance.index)];
    if (c.decided()) target = {c.open.lowest(), c.decided_by, true};
    reason = target.reason;
    if (target.rung == c.present() && (!c.decided() || !c.newcomer || target.rung != Rung::full)) return;

    const bool up = c.newcomer || target.rung > c.rung;
    const Ranked wish{by_distance.distance, by_distance.index, target.rung};
    if (up && target.rung == Rung::full && c.put_off && !c.newcomer) {
      reason = LevelReason::overlap_put_off;
    } else if (c.decided()) {
      (up ? decision_.promote : decision_.demote).push_back({wish.index, wish.to});
    } else if (c.newcomer || (target.at_once && !up)) {
      (up ? promote_at_once_ : demote_at_once_).push_back(wish);
    } else if (c.frames_since_change < settings_.min_dwell_frames) {
      reason = LevelReason::dwell;
    } else {
      (up ? promote_ : demote_).push_back(wish);
    }
  }

  /// Lets wishes come true, as long as there is room, and no more changes than the cap; the rest are queued.
  void grant() {
    std::ranges::sort(promote_at_once_, nearer);
    std::ranges::sort(demote_at_once_, farther);
    const auto turns = std::size_t(std::max(0, settings_.max_transitions_per_frame));
    std::ranges::partial_sort(promote_, promote_.begin() + std::ptrdiff_t(std::min(turns, promote_.size())), nearer);
    std::ranges::partial_sort(demote_, demote_.begin() + std::ptrdiff_t(std::min(turns, demote_.size())), farther);
    for (Ranked& wish : demote_at_once_) {
      if (places_[std::size_t(wish.to)] <= 0) wish.to = candidate(wish).open.lowest();
      make(wish, decision_.demote);
    }
    for (const Ranked& wish : promote_at_once_)
      if (fits(wish)) make(wish, decision_.promote);
      else decision_.reasons[std::size_t(wish.index)] = LevelReason::over_budget;

    std::size_t up = 0, down = 0;
    for (std::size_t left = turns; left > 0; --left) {
      const bool can_rise = up < promote_.size() && fits(promote_[up]), can_fall = down < demote_.size() && places_[std::size_t(demote_[down].to)] > 0;
      if (can_rise && (up <= down || !can_fall)) make(promote_[up++], decision_.promote);
      else if (can_fall) make(demote_[down++], decision_.demote);
      else break;
    }
    for (; up < promote_.size(); ++up) decision_.reasons[std::size_t(promote_[up].index)] = LevelReason::queued;
    for (; down < demote_.size(); ++down) decision_.reasons[std::size_t(demote_[down].index)] = LevelReason::queued;
  }

  double cost_of(const Ranked& wish) const {
    const LevelCandidate& c = candidate(wish);
    return c.cost_at(wish.to) - c.cost_at(c.present()) + overhead_.change[std::size_t(wish.to)];
  }
  bool fits(const Ranked& wish) const { return places_[std::size_t(wish.to)] > 0 && cost_of(wish) <= room_; }
  void make(const Ranked& wish, std::vector<LevelDecision::Change>& changes) {
    changes.push_back({wish.index, wish.to});
    room_ -= cost_of(wish);
    --places_[std::size_t(wish.to)];
    if (!candidate(wish).newcomer) ++places_[std::size_t(candidate(wish).rung)];
  }

  std::span<const LevelCandidate> candidates_;
  std::span<const Vec3> viewpoints_;
  const PolicySettings& settings_;
  const StepOverhead& overhead_;
  LevelDecision decision_;
  double room_ = kInfinity;                                             // of the budget
  std::array<std::int64_t, kRungs> places_{kNoLimit, kNoLimit, kNoLimit};  // for more bodies on each rung
  std::vector<Ranked> promote_at_once_, demote_at_once_, promote_, demote_;
};

}  // namespace

std::string_view text_of(LevelReason reason) {
  switch (reason) {
    case LevelReason::forced: return "the caller chose this level";
    case LevelReason::near: return "near a viewpoint";
    case LevelReason::far: return "far from every viewpoint";
    case LevelReason::within_hysteresis: return "only just past the limit, within the hysteresis";
    case LevelReason::dwell: return "it changed too recently to change again";
    case LevelReason::queued: return "it waits its turn: this step has made all the changes it may";
    case LevelReason::over_budget: return "nearer bodies use up the budget";
    case LevelReason::in_budget: return "among the nearest bodies that fit the budget";
    case LevelReason::most_reached: return "as many nearer bodies as may be on a higher level are there";
    case LevelReason::overlap_put_off: return "its promotion waits until it overlaps no other body";
    case LevelReason::static_ground: return "near static boxes or meshes, which the tables model does not meet";
    case LevelReason::signature_pending: return "its signature is still being measured";
  }
  return "";
}

LevelReason reason_for_rung(const DistancePolicy& policy, Rung rung) {
  return rung == Rung::full || (rung == Rung::support && policy.support_within < kInfinity) ? LevelReason::near : LevelReason::far;
}

// Told without a division.
bool stays_put(const LevelCandidate& c, std::span<const Vec3> viewpoints, const DistancePolicy& policy) {
  if (c.rung == Rung::full || c.decided() || !c.open.has(c.rung)) return false;
  const double squared = squared_distance(c, viewpoints);
  const auto reach_of = [&](double within) { return within * c.importance + c.radius; };
  const auto beyond = [&](double within) { return squared > 1.001 * reach_of(within) * reach_of(within); };
  if (c.open.has(Rung::full) && !beyond(policy.full_within)) return false;
  if (!can_be_in_ring(c) || policy.support_within == kInfinity) return c.rung == c.open.at_most(Rung::support);
  if (c.rung == Rung::tables) return beyond(policy.support_within);
  return squared < 0.999 * reach_of(policy.support_within) * reach_of(policy.support_within);
}

double travel_until_change(const LevelCandidate& c, std::span<const Vec3> viewpoints, const DistancePolicy& policy, double hysteresis) {
  const double nearest = std::sqrt(squared_distance(c, viewpoints));
  const auto reach_of = [&](double within) { return within * c.importance + c.radius; };
  double travel = kInfinity;
  if (c.open.has(Rung::full)) travel = nearest - reach_of(policy.full_within);
  if (!can_be_in_ring(c) || policy.support_within == kInfinity) return travel;
  if (c.rung == Rung::tables) return std::min(travel, nearest - reach_of(policy.support_within));
  return std::min(travel, reach_of(policy.support_within * (1.0 + hysteresis)) - nearest);
}

double rank_distance(const LevelCandidate& c, std::span<const Vec3> viewpoints, double hysteresis) {
  const double distance = scaled_distance(c, viewpoints);
  if (c.newcomer) return distance;
  if (c.rung == Rung::full) return distance / (1.0 + hysteresis);
  return c.rung == Rung::tables && c.open.has(Rung::support) ? distance * (1.0 + hysteresis) : distance;
}

double reach_of_full(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead) {
  return Chooser(candidates, viewpoints, settings, overhead).reach(budget_of(settings));
}

LevelDecision choose_levels(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead) {
  Chooser chooser(candidates, viewpoints, settings, overhead);
  if (const auto* distance = std::get_if<DistancePolicy>(&settings.policy)) return chooser.by(*distance);
  return chooser.by_budget(budget_of(settings));
}

}  // namespace lodestone
