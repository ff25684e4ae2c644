// Each policy says what rung it wants for every body: by limits of distance or size, by a budget for the
// nearest, or by an error budget. What of that changes in this step is the same for all (change_queue.h).
#include "lod/manager/choose_levels.h"

#include <algorithm>

#include "lod/manager/change_queue.h"
#include "lod/manager/share_by_error.h"
#include "lod/manager/share_of_full.h"

namespace lodestone {
namespace {

// Around the full bodies there is a ring of bodies at `support`. Of the room above what the lowest rungs
// cost, full bodies leave it this part, which bodies that rise from `tables` take first.
constexpr double kShareOfRing = 0.25;

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

/// What a budget leaves, in its unit, above what all cost on their lowest rungs.
struct BudgetRoom {
  double keep = 0.0, grow = 0.0;  // for those that are on a higher rung; for more of them
  double now = 0.0;               // left by all as they are; negative: the budget is exceeded
  double full_now = 0.0;          // taken up by those that are full and need not be, with their pairs

  bool over() const { return now < 0.0; }
  /// For the full level; `ring`: whether anybody may be at `support` or `tables`.
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

/// What the policy of the settings wants of every candidate.
class PolicyWishes {
 public:
  PolicyWishes(std::span<const LevelCandidate> candidates, const Views& views, const PolicySettings& settings,
               const StepOverhead& overhead)
      : candidates_(candidates),
        views_(views),
        settings_(settings),
        overhead_(overhead),
        must_be_full_(candidates, overhead),
        queue_(candidates, settings, overhead) {}

  LevelDecision by_limits(const Limits& limits) {
    const bool limited = settings_.most_full < kUnlimited || settings_.most_support < kUnlimited;
    std::vector<Ranked> ranked;
    std::vector<Target> targets;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (!limited && !c.newcomer && stays_put(c, views_, limits)) {
        queue_.keep(i, reason_for_rung(limits, c));
        continue;
      }
      const double distance = remoteness(c, views_, limits.measure);
      ranked.push_back({distance, i});
      targets.push_back(c.decided() ? Target{} : target_by_limits(c, distance, limits, settings_.hysteresis));
    }
    if (limited) limit_numbers(ranked, targets, limits.measure);
    for (std::size_t k = 0; k < ranked.size(); ++k) queue_.add(ranked[k], targets[k]);
    return queue_.grant();
  }

  LevelDecision by_budget(double budget) {
    const BudgetRoom room = find_room(budget);
    queue_.set_room(room.now);
    std::vector<Ranked> may_be_full, others;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (c.decided())
        queue_.add({0.0, i}, {});
      else if (is_out_of_the_picture(c))
        queue_.add({kInfinity, i}, {c.open.lowest(), Rule::out_of_view, room.over()});
      else
        (may_be_full_now(c) ? may_be_full : others)
            .push_back({rank_distance(c, views_, settings_.hysteresis), i});
    }
    share_out(room, std::move(may_be_full), std::move(others));
    return queue_.grant();
  }

  /// A body goes up where that lessens the error most for what it costs.
  LevelDecision by_error(double budget) {
    const BudgetRoom room = find_room(budget);
    queue_.set_room(room.now);
    std::vector<Rung> wanted;
    if (!views_.empty())
      wanted = share_by_error(candidates_, must_be_full_, {room.keep, room.grow},
                              {.most_full = settings_.most_full,
                               .most_support = settings_.most_support,
                               .hysteresis = settings_.hysteresis});
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      const Rung lowest = c.open.lowest(), to = wanted.empty() ? lowest : wanted[std::size_t(i)];
      // Ranked by the error that a change makes or saves: what saves most goes up first, what loses least
      // goes down first.
      const double error =
          to < c.present() ? c.error_at(to) - c.error_at(c.present()) : c.error_at(lowest) - c.error_at(to);
      queue_.add({1.0 / std::max(1e-9, error), i}, {to, reason_by_error(c, to), room.over()});
    }
    return queue_.grant();
  }

  /// The rank distance up to which bodies were looked at for the full level.
  double reach_of_full(double budget) {
    if (views_.empty()) return 0.0;
    const BudgetRoom room = find_room(budget);
    std::vector<Ranked> may_be_full;
    for (std::int32_t i = 0; i < count(); ++i) {
      const LevelCandidate& c = candidates_[std::size_t(i)];
      if (may_be_full_now(c) && !is_out_of_the_picture(c))
        may_be_full.push_back({rank_distance(c, views_, settings_.hysteresis), i});
    }
    return share_full(candidates_, std::move(may_be_full), must_be_full_, room.for_full(has_ring()),
                      settings_.most_full)
        .reach;
  }

 private:
  std::int32_t count() const { return std::int32_t(candidates_.size()); }
  const LevelCandidate& candidate(const Ranked& r) const { return candidates_[std::size_t(r.index)]; }

  bool has_ring() const { return std::ranges::any_of(candidates_, can_be_in_ring); }

  Rule reason_by_error(const LevelCandidate& c, Rung to) const {
    if (to == c.open.highest() || to != c.open.lowest()) return Rule::in_budget;
    if (views_.empty()) return Rule::far;
    return is_out_of_the_picture(c) ? Rule::out_of_view : Rule::over_budget;
  }

  /// The number on a higher rung grows while part of the budget is free, and shrinks when all of it is used
  /// up. Notes what must be full, and what the pairs cost of those that are.
  BudgetRoom find_room(double budget) {
    double lowest = overhead_.others, now = 0.0;
    for (const LevelCandidate& c : candidates_) {
      lowest += c.cost_at(c.open.lowest());
      if (!c.decided())
        now += raise(c, c.present());
      else if (c.open.has(Rung::full))
        must_be_full_.add(c);
    }
    lowest += must_be_full_.total();
    FullBill full = must_be_full_;
    now = add_present_full(full, now);
    const double usable = budget / (1.0 + overhead_.margin);
    return {.keep = std::max(0.0, usable - lowest),
            .grow = std::max(0.0, usable / (1.0 + settings_.hysteresis) - lowest),
            .now = usable - lowest - now,
            .full_now = full.total() - must_be_full_.total()};
  }

  /// Adds those that are full and need not be to the bill. Returns `cost` with what their pairs cost, in the
  /// unit of the budget: the farther of two that meet answers for the pair, as it is the one that goes down.
  double add_present_full(FullBill& bill, double cost) {
    std::vector<Ranked> full_now;
    for (std::int32_t i = 0; i < count(); ++i)
      if (const LevelCandidate& c = candidates_[std::size_t(i)]; !c.decided() && c.present() == Rung::full)
        full_now.push_back({rank_distance(c, views_, 0.0), i});
    std::ranges::sort(full_now, nearer);
    for (const Ranked& r : full_now) {
      const auto pairs = float(bill.price_of_pairs(candidate(r)));
      queue_.set_price_of_pairs(r.index, pairs);
      cost += double(pairs);
      bill.add(candidate(r));
    }
    return cost;
  }

  /// The nearest full, as many as there is room for, the next `support`, the rest on their lowest rungs.
  void share_out(const BudgetRoom& room, std::vector<Ranked> may_be_full, std::vector<Ranked> rest) {
    ShareOfFull share{.taken = {}, .rest = {}, .used = 0.0, .reach = 0.0};
    if (views_.empty())
      share.rest = std::move(may_be_full);
    else
      share = share_full(candidates_, std::move(may_be_full), must_be_full_, room.for_full(has_ring()),
                         settings_.most_full);
    for (const Ranked& r : share.taken) queue_.add(r, {Rung::full, Rule::in_budget});
    rest.insert(rest.end(), share.rest.begin(), share.rest.end());
    const std::span<Ranked> lowest(
        std::partition(rest.begin(), rest.end(),
                       [this](const Ranked& r) { return can_be_in_ring(candidate(r)); }),
        rest.end());
    const std::span<Ranked> may_be_in_ring = std::span(rest).first(rest.size() - lowest.size());
    const double ring = room_of_ring(room, share.used, may_be_in_ring);
    const std::size_t allowed = keep_nearest(may_be_in_ring, settings_.most_support, [this](std::int32_t i) {
      return std::int64_t(candidates_[std::size_t(i)].bodies);
    });
    const std::size_t in_ring = take_nearest(may_be_in_ring.first(allowed), ring, [this](std::int32_t i) {
      return raise(candidates_[std::size_t(i)], Rung::support);
    });
    for (const Ranked& r : may_be_in_ring.first(in_ring))
      queue_.add(r, {Rung::support, Rule::in_budget, room.over()});
    const bool most_in_ring = in_ring == allowed && allowed < may_be_in_ring.size();
    const Rule reason = views_.empty() ? Rule::far : Rule::over_budget;
    for (const Ranked& r : std::span(rest).subspan(in_ring)) {
      const bool limited = can_be_in_ring(candidate(r)) ? most_in_ring : share.most_reached;
      queue_.add(r, {candidate(r).open.lowest(), limited ? Rule::most_reached : reason, room.over()});
    }
  }

  /// What is left for the ring of `support`, in the unit of the budget, where full bodies have used `used`:
  /// it keeps what it has, and grows while part of the budget is free.
  double room_of_ring(const BudgetRoom& room, double used, std::span<const Ranked> may_be_in_ring) const {
    double ring_now = 0.0;
    for (const Ranked& r : may_be_in_ring)
      if (candidate(r).present() != Rung::tables) ring_now += raise(candidate(r), Rung::support);
    return std::min(room.keep - used, std::max(ring_now, room.grow - used));
  }

  /// Sends the farthest of those that are wanted on a rung down where they would be more than the settings'
  /// most.
  void limit_numbers(std::span<const Ranked> ranked, std::span<Target> targets, Measure measure) {
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

  std::span<const LevelCandidate> candidates_;
  const Views& views_;
  const PolicySettings& settings_;
  const StepOverhead& overhead_;
  FullBill must_be_full_;
  ChangeQueue queue_;
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
  return PolicyWishes(candidates, views, settings, overhead).reach_of_full(budget_of(settings));
}

LevelDecision choose_levels(std::span<const LevelCandidate> candidates, const Views& views,
                            const PolicySettings& settings, const StepOverhead& overhead) {
  PolicyWishes wishes(candidates, views, settings, overhead);
  if (const std::optional<Limits> limits = limits_of(settings)) return wishes.by_limits(*limits);
  if (std::holds_alternative<ErrorBudgetPolicy>(settings.policy)) return wishes.by_error(budget_of(settings));
  return wishes.by_budget(budget_of(settings));
}

}  // namespace lodestone
