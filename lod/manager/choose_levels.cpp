// Each policy says what rung it wants for every body; what dwell, queue, caps and room then allow is the same
// for all.
#include "lod/manager/choose_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lod/manager/share_by_error.h"
#include "lod/manager/share_of_full.h"

namespace lodestone {
namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max() / 2;

// Of the room above what the lowest rungs cost, the part that full bodies leave to a ring of `support` around
// them: what goes up from `tables` takes it first.
constexpr double kShareOfRing = 0.25;

/// What the policy itself wants of one body.
struct Target {
  Rung rung = Rung::support;
  Rule reason = Rule::far;
  bool at_once = false;  // neither dwell nor cap may hold it up while too much or too many are there
};

Target target_by_limits(const LevelCandidate& c, double distance, const Limits& limits, double hysteresis) {
  const auto at = [&](Rung rung, Rule reason) { return Target{c.open.at_most(rung), reason}; };
  if (distance <= limits.full_within) return at(Rung::full, Rule::near);
  if (c.hits_full) return at(Rung::full, Rule::look_ahead);
  if (c.present() == Rung::full && distance <= limits.full_within * (1.0 + hysteresis))
    return at(Rung::full, Rule::within_hysteresis);
  const bool in_view = distance <= c.view_factor * limits.full_within;  // it would be full, were it in view
  const Rule far = c.view_factor > 1.0 && in_view ? Rule::out_of_view : Rule::far;
  if (distance <= limits.support_within) return at(Rung::support, limits.three_rungs() ? Rule::near : far);
  if (c.present() != Rung::tables && distance <= limits.support_within * (1.0 + hysteresis))
    return at(Rung::support, Rule::within_hysteresis);
  return at(Rung::tables, c.view_factor > 1.0 ? Rule::out_of_view : Rule::far);
}

/// How many of the places on a rung it takes: those of `support` are for bodies that are awake.
std::int64_t places_of(const LevelCandidate& c, Rung rung) {
  return rung == Rung::support && c.asleep ? 0 : c.bodies;
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

/// Moves the nearest to the front, as many as there is room for, and returns how many they are. Halves in
/// place of a sort.
template <class Cost>
std::size_t take_nearest(std::span<Ranked> ranked, double room, const Cost& cost) {
  std::size_t begin = 0, end = ranked.size();
  while (end - begin > 16) {
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(ranked.begin() + std::ptrdiff_t(begin), ranked.begin() + std::ptrdiff_t(middle),
                     ranked.begin() + std::ptrdiff_t(end), nearer);
    double taken = 0.0;
    for (std::size_t i = begin; i < middle; ++i) taken += cost(ranked[i].index);
    if (taken > room) {
      end = middle;
    } else {
      room -= taken;
      begin = middle;
    }
  }
  std::sort(ranked.begin() + std::ptrdiff_t(begin), ranked.begin() + std::ptrdiff_t(end), nearer);
  for (; begin < end; ++begin)
    if ((room -= cost(ranked[begin].index)) < 0.0) break;
  return begin;
}

/// Moves the nearest to the front, of no more than `most` bodies, and returns how many they are. A group of
/// more than are left is passed over, but nobody beyond the `most` nearest is looked at.
template <class Bodies>
std::size_t keep_nearest(std::span<Ranked> ranked, std::int64_t most, const Bodies& bodies) {
  const auto looked_at = std::size_t(std::min(most, std::int64_t(ranked.size())));
  if (looked_at < ranked.size())
    std::ranges::nth_element(ranked, ranked.begin() + std::ptrdiff_t(looked_at), nearer);
  const std::span<Ranked> nearest = ranked.first(looked_at);
  std::int64_t sum = 0;
  for (const Ranked& r : nearest) sum += bodies(r.index);
  if (sum <= most) return looked_at;
  std::ranges::sort(nearest, nearer);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < looked_at; ++i) {
    const std::int64_t left = most - bodies(ranked[i].index);
    if (left < 0) continue;
    most = left;
    std::swap(ranked[kept++], ranked[i]);
  }
  return kept;
}

class Chooser {
 public:
  Chooser(std::span<const LevelCandidate> candidates, const Views& views, const PolicySettings& settings,
          const StepOverhead& overhead)
      : candidates_(candidates),
        views_(views),
        settings_(settings),
        overhead_(overhead),
        forced_(candidates, overhead),
        stays_full_(forced_),
        pairs_(candidates.size()),
        goes_down_(candidates.size()) {
    decision_.reasons.resize(candidates.size());
    count_limits();
  }

  LevelDecision by(const Limits& limits) {
    const bool limited = settings_.most_full < kUnlimited || settings_.most_support < kUnlimited;
    std::vector<Ranked> ranked;
    std::vector<Target> targets;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (!limited && !c.newcomer && stays_put(c, views_, limits)) {
        decision_.reasons[std::size_t(i)] = reason_for_rung(limits, c);
        continue;
      }
      const double distance = remoteness(c, views_, limits.measure);
      ranked.push_back({distance, i});
      targets.push_back(c.decided() ? Target{} : target_by_limits(c, distance, limits, settings_.hysteresis));
    }
    if (limited) limit(ranked, targets, limits.measure);
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
      if (c.decided())
        consider({0.0, i}, {});
      else if (is_out_of_the_picture(c))
        consider({kInfinity, i}, {c.open.lowest(), Rule::out_of_view, room.over()});
      else
        (may_be_full_now(c, settings_.min_dwell_frames) ? may_be_full : others)
            .push_back({rank_distance(c, views_, settings_.hysteresis), i});
    }
    share_out(room, std::move(may_be_full), std::move(others));
    grant();
    return std::move(decision_);
  }

  /// A body goes up where that lessens the error most for what it costs.
  LevelDecision by_error(double budget) {
    const BudgetRoom room = find_room(budget);
    room_ = room.now;
    std::vector<Rung> wanted;
    if (!views_.empty())
      wanted = share_by_error(candidates_, forced_, {room.keep, room.grow},
                              {.most_full = settings_.most_full,
                               .most_support = settings_.most_support,
                               .hysteresis = settings_.hysteresis,
                               .min_dwell_frames = settings_.min_dwell_frames});
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      const Rung to = wanted.empty() ? c.open.lowest() : wanted[std::size_t(i)];
      const Rule reason = to == c.open.highest() || to != c.open.lowest() ? Rule::in_budget
                          : views_.empty()                                ? Rule::far
                          : is_out_of_the_picture(c)                      ? Rule::out_of_view
                                                                          : Rule::over_budget;
      const double nearness = 1.0 / std::max(1e-9, c.error_at(c.open.lowest()) -
                                                       c.error_at(to));  // what saves most goes up first
      consider(
          {to < c.present() ? 1.0 / std::max(1e-9, c.error_at(to) - c.error_at(c.present())) : nearness, i},
          {to, reason, room.over()});
    }
    grant();
    return std::move(decision_);
  }

  /// The rank distance up to which bodies were looked at for the full level.
  double reach(double budget) {
    if (views_.empty()) return 0.0;
    const BudgetRoom room = find_room(budget);
    std::vector<Ranked> may_be_full;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (may_be_full_now(c, settings_.min_dwell_frames) && !is_out_of_the_picture(c))
        may_be_full.push_back({rank_distance(c, views_, settings_.hysteresis), i});
    }
    return share_full(candidates_, std::move(may_be_full), forced_, room.for_full(has_ring()),
                      settings_.most_full)
        .reach;
  }

 private:
  std::int32_t count() const { return std::int32_t(candidates_.size()); }
  const LevelCandidate& candidate(const Ranked& r) const { return candidates_[std::size_t(r.index)]; }

  bool has_ring() const { return std::ranges::any_of(candidates_, can_be_in_ring); }

  /// The number on a higher rung grows while part of the budget is free, and shrinks when all of it is used
  /// up. Notes what must be full, and what the pairs cost of those that are.
  BudgetRoom find_room(double budget) {
    BudgetRoom room;
    double lowest = overhead_.others, now = 0.0;
    pairs_.assign(candidates_.size(), 0.0f);
    for (const LevelCandidate& c : candidates_) {
      lowest += c.cost_at(c.open.lowest());
      if (!c.decided())
        now += raise(c, c.present());
      else if (c.open.has(Rung::full))
        forced_.add(c);
    }
    lowest += forced_.total();
    // The farther of two that meet answers for the pair: it is the one that goes down.
    FullBill full = forced_;
    std::vector<Ranked> full_now;
    for (std::int32_t i = 0; i < count(); ++i)
      if (const LevelCandidate& c = candidates_[std::size_t(i)]; !c.decided() && c.present() == Rung::full)
        full_now.push_back({rank_distance(c, views_, 0.0), i});
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
    if (views_.empty())
      share.rest = std::move(may_be_full);
    else
      share = share_full(candidates_, std::move(may_be_full), forced_, room.for_full(has_ring()),
                         settings_.most_full);
    for (const Ranked& r : share.taken) consider(r, {Rung::full, Rule::in_budget});
    rest.insert(rest.end(), share.rest.begin(), share.rest.end());
    const std::span<Ranked> lowest(
        std::partition(rest.begin(), rest.end(),
                       [this](const Ranked& r) { return can_be_in_ring(candidate(r)); }),
        rest.end());
    const std::span<Ranked> may_be_in_ring = std::span(rest).first(rest.size() - lowest.size());
    double ring_now = 0.0;
    for (const Ranked& r : may_be_in_ring)
      if (candidate(r).present() != Rung::tables) ring_now += raise(candidate(r), Rung::support);
    const double room_of_ring = std::min(room.keep - share.used, std::max(ring_now, room.grow - share.used));
    const std::size_t allowed = keep_nearest(may_be_in_ring, settings_.most_support, [this](std::int32_t i) {
      return std::int64_t(candidates_[std::size_t(i)].bodies);
    });
    const std::size_t support =
        take_nearest(may_be_in_ring.first(allowed), room_of_ring,
                     [this](std::int32_t i) { return raise(candidates_[std::size_t(i)], Rung::support); });
    const bool most_support = support == allowed && allowed < may_be_in_ring.size();
    for (const Ranked& r : may_be_in_ring.first(support))
      consider(r, {Rung::support, Rule::in_budget, room.over()});
    const Rule reason = views_.empty() ? Rule::far : Rule::over_budget;
    for (const Ranked& r : std::span(rest).subspan(support)) {
      const bool limited = can_be_in_ring(candidate(r)) ? most_support : share.most_reached;
      consider(r, {candidate(r).open.lowest(), limited ? Rule::most_reached : reason, room.over()});
    }
  }

  /// Sends the farthest of those that are wanted on a rung down where they would be more than `most`.
  void limit(std::span<const Ranked> ranked, std::span<Target> targets, Measure measure) {
    for (const auto& [rung, most] :
         {std::pair{Rung::full, settings_.most_full}, {Rung::support, settings_.most_support}}) {
      std::vector<Ranked> wanted;
      for (std::size_t k = 0; k < ranked.size(); ++k) {
        const LevelCandidate& c = candidate(ranked[k]);
        if (!c.decided() && targets[k].rung == rung && c.open.lowest() < rung)
          wanted.push_back({rank_distance(c, views_, settings_.hysteresis, measure), std::int32_t(k)});
      }
      const auto bodies = [&](std::int32_t k) {
        return std::int64_t(candidate(ranked[std::size_t(k)]).bodies);
      };
      for (const Ranked& w : std::span(wanted).subspan(keep_nearest(wanted, most, bodies)))
        targets[std::size_t(w.index)] = {
            candidate(ranked[std::size_t(w.index)]).open.at_most(Rung(int(rung) - 1)), Rule::most_reached};
    }
  }

  /// How many more the policy may put on each rung.
  void count_limits() {
    places_[std::size_t(Rung::full)] = settings_.most_full < kUnlimited ? settings_.most_full : kNoLimit;
    places_[std::size_t(Rung::support)] =
        settings_.most_support < kUnlimited ? settings_.most_support : kNoLimit;
    for (const LevelCandidate& c : candidates_)
      if (!c.decided() && !c.newcomer) places_[std::size_t(c.rung)] -= places_of(c, c.rung);
  }
  bool has_place(const Ranked& wish) const {
    const std::int64_t needed = places_of(candidate(wish), wish.to);
    return needed == 0 || places_[std::size_t(wish.to)] >= needed;
  }
  bool is_one_too_many(const LevelCandidate& c) const {
    return places_of(c, c.rung) > 0 && places_[std::size_t(c.rung)] < 0;
  }
  /// On its lowest rung whatever the limit.
  bool can_fall(const Ranked& wish) const {
    return wish.to == candidate(wish).open.lowest() || has_place(wish);
  }
  /// Whether each goes where the other comes from, and only so has a place.
  bool can_exchange(const Ranked& fall, const Ranked& rise) {
    const LevelCandidate &falls = candidate(fall), &rises = candidate(rise);
    if (falls.rung != rise.to || rises.rung != fall.to) return false;
    note_price_of_pairs(rise);
    const auto fit = [this](const LevelCandidate& comes, const LevelCandidate& goes, Rung rung) {
      return places_[std::size_t(rung)] + places_of(goes, rung) >= places_of(comes, rung);
    };
    return fit(rises, falls, rise.to) && fit(falls, rises, fall.to) && cost_of(fall) + cost_of(rise) <= room_;
  }
  /// Whether others make room once their dwell is over.
  bool leaves_place_later(const Ranked& wish) const {
    return places_[std::size_t(wish.to)] + held_by_dwell_[std::size_t(wish.to)] >=
           places_of(candidate(wish), wish.to);
  }

  /// Notes why a body has its rung, and its wish for a change.
  void consider(const Ranked& by_distance, Target target) {
    const LevelCandidate& c = candidate(by_distance);
    Rule& reason = decision_.reasons[std::size_t(by_distance.index)];
    if (c.decided()) target = {c.open.lowest(), c.decided_by, true};
    reason =
        c.put_off && c.rung != Rung::full && target.rung == c.rung ? Rule::overlap_put_off : target.reason;
    if (target.rung == c.present() && (!c.decided() || !c.newcomer || target.rung != Rung::full)) return;

    const bool up = c.newcomer || target.rung > c.rung;
    const Ranked wish{by_distance.distance, by_distance.index, target.rung};
    if (up && target.rung == Rung::full && c.put_off && !c.newcomer) {
      reason = Rule::overlap_put_off;
    } else if (c.decided()) {
      (up ? decision_.promote : decision_.demote).push_back({wish.index, wish.to});
    } else if (c.newcomer || must_leave(c) || (!up && (target.at_once || is_one_too_many(c)))) {
      (up ? promote_at_once_ : demote_at_once_).push_back(wish);
    } else {
      hold_or_queue(wish, up ? promote_ : demote_);
    }
  }

  /// Whether its caller has closed the rung that it is on.
  static bool must_leave(const LevelCandidate& c) { return !c.open.has(c.present()); }

  void hold_or_queue(const Ranked& wish, std::vector<Ranked>& queue) {
    const LevelCandidate& c = candidate(wish);
    if (c.frames_since_change >= settings_.min_dwell_frames) return queue.push_back(wish);
    decision_.reasons[std::size_t(wish.index)] = Rule::dwell;
    held_by_dwell_[std::size_t(c.rung)] += places_of(c, c.rung);
  }

  /// Lets wishes come true, as long as there is room, and no more changes than the cap; the rest are queued.
  void grant() {
    std::ranges::sort(promote_at_once_, nearer);
    // Of a sleeper most of what it is charged is a reserve: its going down frees hardly any time.
    std::ranges::sort(demote_at_once_, [this](const Ranked& a, const Ranked& b) {
      const bool sleeps = candidate(a).asleep, other_sleeps = candidate(b).asleep;
      return sleeps != other_sleeps ? other_sleeps : farther(a, b);
    });
    for (Ranked& wish : demote_at_once_) {
      const LevelCandidate& c = candidate(wish);
      if (!must_leave(c) && room_ >= 0.0 && !is_one_too_many(c)) {  // enough went down
        hold_or_queue(wish, demote_);
        continue;
      }
      if (!has_place(wish)) wish.to = c.open.lowest();
      make(wish, decision_.demote);
    }
    const auto turns = std::size_t(std::max(0, settings_.max_transitions_per_frame));
    const std::size_t in_order = std::min(turns + kPassedOver, promote_.size()),
                      falls_in_order = std::min(turns + kPassedOver, demote_.size());
    std::ranges::partial_sort(promote_, promote_.begin() + std::ptrdiff_t(in_order), nearer);
    std::ranges::partial_sort(demote_, demote_.begin() + std::ptrdiff_t(falls_in_order), farther);
    // Those that stay full for now are met, too, wanted or not.
    for (std::int32_t i = 0; i < count(); ++i)
      if (const LevelCandidate& c = candidates_[std::size_t(i)];
          !c.decided() && c.present() == Rung::full && !goes_down_[std::size_t(i)])
        stays_full_.add(c);
    for (const Ranked& wish : promote_at_once_)
      if (fits(wish))
        make(wish, decision_.promote);
      else
        decision_.reasons[std::size_t(wish.index)] = Rule::over_budget;

    std::size_t up = 0, down = 0;
    std::size_t left = turns;
    const auto may_fall = [this](const Ranked& wish) { return can_fall(wish); };
    const auto takes_its_place = [&](const Ranked& wish) { return can_exchange(demote_[down], wish); };
    for (; left > 0; --left) {
      for (; up < in_order && places_[std::size_t(promote_[up].to)] > 0 && !fits(promote_[up]) &&
             fits_but_for_pairs(promote_[up]);
           ++up)
        decision_.reasons[std::size_t(promote_[up].index)] = Rule::queued;
      const bool rises = up < in_order && fits(promote_[up]),
                 falls = bring_forward(demote_, down, falls_in_order, may_fall);
      if (rises && (up <= down || !falls)) {
        make(promote_[up++], decision_.promote);
      } else if (falls) {
        make(demote_[down++], decision_.demote);
      } else if (down == demote_.size() || (left == 1 && turns > 1)) {
        break;
      } else if (left > 1 && bring_forward(promote_, up, in_order, takes_its_place)) {
        make(demote_[down++], decision_.demote);
        make(promote_[up++], decision_.promote);
        --left;
      } else if (leaves_place_later(demote_[down])) {
        break;
      } else {
        demote_[down].to = candidate(demote_[down]).open.lowest();
        make(demote_[down++], decision_.demote);
      }
    }
    // The nearest may wait for a place that another leaves by rising farther.
    if (up < in_order && !has_place(promote_[up]))
      for (std::size_t k = up + 1; k < in_order && left > 0; ++k)
        if (promote_[k].to != promote_[up].to && fits(promote_[k])) {
          make(promote_[k], decision_.promote);
          std::rotate(promote_.begin() + std::ptrdiff_t(up), promote_.begin() + std::ptrdiff_t(k),
                      promote_.begin() + std::ptrdiff_t(k + 1));
          ++up, --left;
        }
    for (; up < promote_.size(); ++up) decision_.reasons[std::size_t(promote_[up].index)] = Rule::queued;
    for (; down < demote_.size(); ++down) decision_.reasons[std::size_t(demote_[down].index)] = Rule::queued;
  }

  /// Moves the first that may to the place `at` of those that are in order.
  template <class May>
  static bool bring_forward(std::vector<Ranked>& wishes, std::size_t at, std::size_t in_order,
                            const May& may) {
    const std::size_t end = std::min(at + 1 + kPassedOver, in_order);
    for (std::size_t k = at; k < end; ++k) {
      if (!may(wishes[k])) continue;
      std::rotate(wishes.begin() + std::ptrdiff_t(at), wishes.begin() + std::ptrdiff_t(k),
                  wishes.begin() + std::ptrdiff_t(k + 1));
      return true;
    }
    return false;
  }

  double cost_of(const Ranked& wish) const {
    const LevelCandidate& c = candidate(wish);
    const double pairs = double(pairs_[std::size_t(wish.index)]);
    const double change_of_pairs = wish.to == Rung::full ? pairs : c.present() == Rung::full ? -pairs : 0.0;
    return c.cost_at(wish.to) - c.cost_at(c.present()) + change_of_pairs +
           double(c.bodies) * overhead_.change[std::size_t(wish.to)];
  }
  void note_price_of_pairs(const Ranked& wish) {
    if (wish.to == Rung::full)
      pairs_[std::size_t(wish.index)] = float(stays_full_.price_of_pairs(candidate(wish)));
  }
  bool fits(const Ranked& wish) {
    note_price_of_pairs(wish);
    return has_place(wish) && cost_of(wish) <= room_;
  }
  bool fits_but_for_pairs(const Ranked& wish) const {
    return wish.to == Rung::full && cost_of(wish) - double(pairs_[std::size_t(wish.index)]) <= room_;
  }
  void make(const Ranked& wish, std::vector<LevelDecision::Change>& changes) {
    const LevelCandidate& c = candidate(wish);
    changes.push_back({wish.index, wish.to});
    room_ -= cost_of(wish);
    places_[std::size_t(wish.to)] -= places_of(c, wish.to);
    if (!c.newcomer) places_[std::size_t(c.rung)] += places_of(c, c.rung);
    if (wish.to == Rung::full)
      stays_full_.add(c);
    else
      goes_down_[std::size_t(wish.index)] = true;
  }

  std::span<const LevelCandidate> candidates_;
  const Views& views_;
  const PolicySettings& settings_;
  const StepOverhead& overhead_;
  FullBill forced_, stays_full_;  // of those that must be full; with those that are for now
  std::vector<float> pairs_;      // what those of a candidate cost that is full, or shall be
  std::vector<char> goes_down_;   // or to `support`
  LevelDecision decision_;
  double room_ = kInfinity;                                                // of the budget
  std::array<std::int64_t, kRungs> places_{kNoLimit, kNoLimit, kNoLimit};  // for more bodies on each rung
  std::array<std::int64_t, kRungs> held_by_dwell_{};  // bodies on each rung that leave it after their dwell
  std::vector<Ranked> promote_at_once_, demote_at_once_, promote_, demote_;
};

}  // namespace

bool counts_work(const PolicySettings& settings) {
  if (const auto* error = std::get_if<ErrorBudgetPolicy>(&settings.policy))
    return error->budget_work.has_value();
  return std::holds_alternative<WorkPolicy>(settings.policy);
}

double budget_of(const PolicySettings& settings) {
  if (const auto* timed = std::get_if<BudgetPolicy>(&settings.policy)) return timed->budget_ms;
  if (const auto* error = std::get_if<ErrorBudgetPolicy>(&settings.policy))
    return error->budget_work.value_or(error->budget_ms);
  return std::get<WorkPolicy>(settings.policy).budget_work;
}

double reach_of_full(std::span<const LevelCandidate> candidates, const Views& views,
                     const PolicySettings& settings, const StepOverhead& overhead) {
  return Chooser(candidates, views, settings, overhead).reach(budget_of(settings));
}

LevelDecision choose_levels(std::span<const LevelCandidate> candidates, const Views& views,
                            const PolicySettings& settings, const StepOverhead& overhead) {
  Chooser chooser(candidates, views, settings, overhead);
  if (const std::optional<Limits> limits = limits_of(settings)) return chooser.by(*limits);
  if (std::holds_alternative<ErrorBudgetPolicy>(settings.policy))
    return chooser.by_error(budget_of(settings));
  return chooser.by_budget(budget_of(settings));
}

}  // namespace lodestone
