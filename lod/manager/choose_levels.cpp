// Each policy says what rung it wants for every body; what dwell, queue, caps and room then allow is the same for all.
#include "lod/manager/choose_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lod/manager/share_of_full.h"

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
  bool at_once = false;  // neither dwell nor cap may hold it up while too much or too many are there
};

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
  double now = 0.0;               // left by all as they are
  double full_now = 0.0;          // taken up by those that are full, with their pairs

  bool over() const { return now < 0.0; }
  /// Whoever of the three rungs may be asked leaves some to the ring.
  double for_full(bool ring) const {
    const double share = ring ? 1.0 - kShareOfRing : 1.0;
    return std::min(share * keep, std::max(full_now, share * grow));
  }
};

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

// One that has to wait gives room to others meanwhile.
bool may_be_full_now(const LevelCandidate& c, int min_dwell_frames) {
  if (c.decided() || !c.open.has(Rung::full)) return false;
  return c.present() == Rung::full || c.newcomer || (!c.put_off && c.frames_since_change >= min_dwell_frames);
}

bool can_be_in_ring(const LevelCandidate& c) { return !c.decided() && c.open.has(Rung::tables) && c.open.has(Rung::support); }

class Chooser {
 public:
  Chooser(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead)
      : candidates_(candidates), viewpoints_(viewpoints), settings_(settings), overhead_(overhead), forced_(candidates, overhead), stays_full_(forced_), pairs_(candidates.size()), goes_down_(candidates.size()) {
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
    const BudgetRoom room = find_room(budget);
    room_ = room.now;
    std::vector<Ranked> may_be_full, others;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (c.decided()) consider({0.0, i}, {});
      else (may_be_full_now(c, settings_.min_dwell_frames) ? may_be_full : others).push_back({rank_distance(c, viewpoints_, settings_.hysteresis), i});
    }
    share_out(room, std::move(may_be_full), std::move(others));
    count_limits();
    grant();
    return std::move(decision_);
  }

  /// The rank distance up to which bodies were looked at for the full level.
  double reach(double budget) {
    if (viewpoints_.empty()) return 0.0;
    const BudgetRoom room = find_room(budget);
    std::vector<Ranked> may_be_full;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (may_be_full_now(c, settings_.min_dwell_frames)) may_be_full.push_back({rank_distance(c, viewpoints_, settings_.hysteresis), i});
    }
    return share_full(candidates_, std::move(may_be_full), forced_, room.for_full(has_ring()), settings_.most_full).reach;
  }

 private:
  std::int32_t count() const { return std::int32_t(candidates_.size()); }
  const LevelCandidate& candidate(const Ranked& r) const { return candidates_[std::size_t(r.index)]; }

  bool has_ring() const { return std::ranges::any_of(candidates_, can_be_in_ring); }

  /// The number on a higher rung grows while part of the budget is free, and shrinks when all of it is used up. Notes what must be full, and what the pairs cost of those that
  /// are.
  BudgetRoom find_room(double budget) {
    BudgetRoom room;
    double lowest = overhead_.others, now = 0.0;
    pairs_.assign(candidates_.size(), 0.0f);
    for (const LevelCandidate& c : candidates_) {
      lowest += c.cost_at(c.open.lowest());
      if (!c.decided()) now += raise(c, c.present());
      else if (c.open.has(Rung::full)) forced_.add(c);
    }
    lowest += forced_.total();
    // The farther of two that meet answers for the pair: it is the one that goes down.
    FullBill full = forced_;
    std::vector<Ranked> full_now;
    for (std::int32_t i = 0; i < count(); ++i)
      if (const LevelCandidate& c = candidates_[std::size_t(i)]; !c.decided() && c.present() == Rung::full) full_now.push_back({rank_distance(c, viewpoints_, 0.0), i});
    std::ranges::sort(full_now, nearer);
    for (const Ranked& r : full_now) {
      float& pairs = pairs_[std::size_t(r.index)] = float(full.price_of_pairs(candidate(r)));
      now += double(pairs);
      full.add(candidate(r));
    }
    const double usable = budget / (1.0 + overhead_.margin);
    room.full_now = full.total() - forced_.total();
    room.keep = std::max(0.0, usable - lowest);
    room.grow = std::max(0.0, usable / (1.0 + settings_.hysteresis) - lowest);
    room.now = usable - lowest - now;
    return room;
  }

  /// The nearest full, as many as there is room for, the next `support`, the rest on their lowest rungs.
  void share_out(const BudgetRoom& room, std::vector<Ranked> may_be_full, std::vector<Ranked> rest) {
    ShareOfFull share{.taken = {}, .rest = {}, .used = 0.0, .reach = 0.0};
    if (viewpoints_.empty()) share.rest = std::move(may_be_full);
    else share = share_full(candidates_, std::move(may_be_full), forced_, room.for_full(has_ring()), settings_.most_full);
    const bool most_full = !share.rest.empty() && std::int64_t(share.taken.size()) == settings_.most_full;
    for (const Ranked& r : share.taken) consider(r, {Rung::full, LevelReason::in_budget});
    rest.insert(rest.end(), share.rest.begin(), share.rest.end());
    const std::span<Ranked> lowest(std::ranges::partition(rest, [this](const Ranked& r) { return can_be_in_ring(candidate(r)); }));
    const std::span<Ranked> may_be_in_ring = std::span(rest).first(rest.size() - lowest.size());
    double ring_now = 0.0;
    for (const Ranked& r : may_be_in_ring)
      if (candidate(r).present() != Rung::tables) ring_now += raise(candidate(r), Rung::support);
    const double room_of_ring = std::min(room.keep - share.used, std::max(ring_now, room.grow - share.used));
    const std::size_t support = take_nearest(may_be_in_ring, room_of_ring, settings_.most_support, [this](std::int32_t i) { return raise(candidates_[std::size_t(i)], Rung::support); });
    const bool most_support = support < may_be_in_ring.size() && std::int64_t(support) == settings_.most_support;
    for (const Ranked& r : may_be_in_ring.first(support)) consider(r, {Rung::support, LevelReason::in_budget, room.over()});
    const LevelReason reason = viewpoints_.empty() ? LevelReason::far : LevelReason::over_budget;
    for (const Ranked& r : std::span(rest).subspan(support)) {
      const bool limited = can_be_in_ring(candidate(r)) ? most_support : most_full;
      consider(r, {candidate(r).open.lowest(), limited ? LevelReason::most_reached : reason, room.over()});
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
    reason = c.put_off && c.rung != Rung::full && target.rung == c.rung ? LevelReason::overlap_put_off : target.reason;
    if (target.rung == c.present() && (!c.decided() || !c.newcomer || target.rung != Rung::full)) return;

    const bool up = c.newcomer || target.rung > c.rung;
    const Ranked wish{by_distance.distance, by_distance.index, target.rung};
    if (up && target.rung == Rung::full && c.put_off && !c.newcomer) {
      reason = LevelReason::overlap_put_off;
    } else if (c.decided()) {
      (up ? decision_.promote : decision_.demote).push_back({wish.index, wish.to});
    } else if (c.newcomer || (target.at_once && !up)) {
      (up ? promote_at_once_ : demote_at_once_).push_back(wish);
    } else {
      hold_or_queue(wish, up ? promote_ : demote_);
    }
  }

  void hold_or_queue(const Ranked& wish, std::vector<Ranked>& queue) {
    if (candidate(wish).frames_since_change < settings_.min_dwell_frames) decision_.reasons[std::size_t(wish.index)] = LevelReason::dwell;
    else queue.push_back(wish);
  }

  /// Lets wishes come true, as long as there is room, and no more changes than the cap; the rest are queued.
  void grant() {
    std::ranges::sort(promote_at_once_, nearer);
    std::ranges::sort(demote_at_once_, farther);
    for (Ranked& wish : demote_at_once_) {
      if (room_ >= 0.0 && places_[std::size_t(candidate(wish).rung)] >= 0) {  // enough went down
        hold_or_queue(wish, demote_);
        continue;
      }
      if (places_[std::size_t(wish.to)] <= 0) wish.to = candidate(wish).open.lowest();
      make(wish, decision_.demote);
    }
    const auto turns = std::size_t(std::max(0, settings_.max_transitions_per_frame));
    const std::size_t in_order = std::min(turns + kPassedOver, promote_.size());
    std::ranges::partial_sort(promote_, promote_.begin() + std::ptrdiff_t(in_order), nearer);
    std::ranges::partial_sort(demote_, demote_.begin() + std::ptrdiff_t(std::min(turns, demote_.size())), farther);
    // Those that stay full for now are met, too, wanted or not.
    for (std::int32_t i = 0; i < count(); ++i)
      if (const LevelCandidate& c = candidates_[std::size_t(i)]; !c.decided() && c.present() == Rung::full && !goes_down_[std::size_t(i)]) stays_full_.add(c);
    for (const Ranked& wish : promote_at_once_)
      if (fits(wish)) make(wish, decision_.promote);
      else decision_.reasons[std::size_t(wish.index)] = LevelReason::over_budget;

    std::size_t up = 0, down = 0;
    for (std::size_t left = turns; left > 0; --left) {
      for (; up < in_order && places_[std::size_t(promote_[up].to)] > 0 && !fits(promote_[up]) && fits_but_for_pairs(promote_[up]); ++up)
        decision_.reasons[std::size_t(promote_[up].index)] = LevelReason::queued;
      const bool can_rise = up < in_order && fits(promote_[up]), can_fall = down < demote_.size() && places_[std::size_t(demote_[down].to)] > 0;
      if (can_rise && (up <= down || !can_fall)) make(promote_[up++], decision_.promote);
      else if (can_fall) make(demote_[down++], decision_.demote);
      else break;
    }
    for (; up < promote_.size(); ++up) decision_.reasons[std::size_t(promote_[up].index)] = LevelReason::queued;
    for (; down < demote_.size(); ++down) decision_.reasons[std::size_t(demote_[down].index)] = LevelReason::queued;
  }

  double cost_of(const Ranked& wish) const {
    const LevelCandidate& c = candidate(wish);
    const double pairs = double(pairs_[std::size_t(wish.index)]);
    const double change_of_pairs = wish.to == Rung::full ? pairs : c.present() == Rung::full ? -pairs : 0.0;
    return c.cost_at(wish.to) - c.cost_at(c.present()) + change_of_pairs + overhead_.change[std::size_t(wish.to)];
  }
  bool fits(const Ranked& wish) {
    if (wish.to == Rung::full) pairs_[std::size_t(wish.index)] = float(stays_full_.price_of_pairs(candidate(wish)));
    return places_[std::size_t(wish.to)] > 0 && cost_of(wish) <= room_;
  }
  bool fits_but_for_pairs(const Ranked& wish) const { return wish.to == Rung::full && cost_of(wish) - double(pairs_[std::size_t(wish.index)]) <= room_; }
  void make(const Ranked& wish, std::vector<LevelDecision::Change>& changes) {
    changes.push_back({wish.index, wish.to});
    room_ -= cost_of(wish);
    --places_[std::size_t(wish.to)];
    if (!candidate(wish).newcomer) ++places_[std::size_t(candidate(wish).rung)];
    if (wish.to == Rung::full) stays_full_.add(candidate(wish));
    else goes_down_[std::size_t(wish.index)] = true;
  }

  std::span<const LevelCandidate> candidates_;
  std::span<const Vec3> viewpoints_;
  const PolicySettings& settings_;
  const StepOverhead& overhead_;
  FullBill forced_, stays_full_;                                        // of those that must be full; with those that are for now
  std::vector<float> pairs_;                                            // what those of a candidate cost that is full, or shall be
  std::vector<char> goes_down_;                                         // or to `support`
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
