// Which bodies a budget makes full: the nearest first, each with what it costs and with the pairs that it
// makes with those before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/manager/choose_levels.h"
#include "lod/manager/full_pairs.h"

namespace lodestone {

/// A body by its distance, or by its rank among the others; ties go to the lower index, so that the order is
/// the same in every run.
struct Ranked {
  double distance = 0.0;
  std::int32_t index = 0;
  Rung to = Rung::support;
};
inline bool nearer(const Ranked& a, const Ranked& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
}
inline bool farther(const Ranked& a, const Ranked& b) { return nearer(b, a); }

/// What a sleeper, or a pair of sleepers, is charged of what it costs just after it woke: where all wake at
/// once, the step takes twice the budget at most.
inline constexpr double kChargeOfSleepers = 0.5;

/// So many are passed over whose pairs do not fit, and no more: beyond them bodies are too far from the
/// nearest to be worth a look.
inline constexpr std::size_t kPassedOver = 20;

/// Above its lowest rung, without pairs.
inline double raise(const LevelCandidate& c, Rung to) { return c.cost_at(to) - c.cost_at(c.open.lowest()); }

/// One that has to wait gives room to others meanwhile.
inline bool may_be_full_now(const LevelCandidate& c) {
  if (c.decided() || !c.open.has(Rung::full)) return false;
  return c.present() == Rung::full || c.newcomer || (!c.put_off && c.dwell_left == 0);
}

/// What full bodies cost, in the unit of the budget, above their lowest rungs.
class FullBill {
 public:
  FullBill(std::span<const LevelCandidate> candidates, const StepOverhead& overhead);
  /// Of the pairs that one more makes, with those so far and within it.
  double price_of_pairs(const LevelCandidate& candidate) const;
  void add(const LevelCandidate& candidate);
  double total() const { return total_; }

 private:
  double price_of(const PairWeights& pairs) const;
  PairWeights pairs_of(const LevelCandidate& candidate) const;

  const StepOverhead* overhead_;
  FullPairs pairs_;
  double dearest_ = 0.0;  // weight of a pair that is awake
  double total_ = 0.0;
};

struct ShareOfFull {
  std::vector<Ranked> taken, rest;
  double used = 0.0;
  double reach = 0.0;  ///< rank distance beyond which nobody was looked at; infinite where everybody was
  bool most_reached = false;  ///< whether any is left out for being more than `most`
};

/// `bill` has those that must be full. One whose pairs do not fit, or that is a group of more than `most`
/// bodies leaves, is passed over.
ShareOfFull share_full(std::span<const LevelCandidate> candidates, std::vector<Ranked> ranked, FullBill bill,
                       double room, std::int64_t most);

}  // namespace lodestone
