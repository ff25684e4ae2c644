// From what a policy wants to what changes in this step: a wish for another rung waits for its body's dwell
// to end, for a place on the rung, for room in the budget, and for its turn under the cap on changes per
// step. The same for every policy. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/manager/choose_levels.h"
#include "lod/manager/share_of_full.h"

namespace lodestone {

/// What the policy itself wants of one body.
struct Target {
  Rung rung = Rung::support;
  Rule reason = Rule::far;
  bool at_once = false;  ///< while the budget or a limit is exceeded, neither dwell nor cap delays it
};

class ChangeQueue {
 public:
  /// All that is given must outlive it.
  ChangeQueue(std::span<const LevelCandidate> candidates, const PolicySettings& settings,
              const StepOverhead& overhead);

  /// What the budget leaves when all stay as they are, in its unit; negative: it is exceeded. Without a call
  /// there is no budget.
  void set_room(double room) { room_ = room; }
  /// What the pairs of one that is full cost, in the unit of the budget: what its going down frees.
  void set_price_of_pairs(std::int32_t candidate, double price) {
    price_of_pairs_[std::size_t(candidate)] = float(price);
  }
  /// The policy wants no change of it.
  void keep(std::int32_t candidate, Rule reason) { decision_.reasons[std::size_t(candidate)] = reason; }
  /// What the policy wants of one; `by_distance` says who it is, and ranks it among the others.
  void add(const Ranked& by_distance, Target target);
  /// Once all are added.
  LevelDecision grant();

 private:
  /// Where the turns of the queues are: of each, the first few are in order.
  struct Turns {
    std::size_t left = 0;  // changes that the cap still allows
    std::size_t rises_in_order = 0, falls_in_order = 0;
    std::size_t up = 0, down = 0;  // first that has not been granted, of promote_ and demote_
  };

  const LevelCandidate& candidate(const Ranked& r) const { return candidates_[std::size_t(r.index)]; }
  void count_places();
  bool has_place(const Ranked& wish) const;
  bool is_one_too_many(const LevelCandidate& c) const;
  bool can_fall(const Ranked& wish) const;
  bool can_exchange(const Ranked& fall, const Ranked& rise);
  bool leaves_place_later(const Ranked& wish) const;
  void hold_or_queue(const Ranked& wish, std::vector<Ranked>& queue);

  void demote_at_once();
  Turns put_in_order();
  void note_staying_full();
  void promote_at_once();
  void take_turns(Turns& turns);
  void skip_dear_pairs(Turns& turns);
  bool take_turn(Turns& turns);
  void rise_past_waiting(Turns& turns);
  void leave_queued(const Turns& turns);

  double cost_of(const Ranked& wish) const;
  void update_price_of_pairs(const Ranked& wish);
  bool fits(const Ranked& wish);
  bool fits_but_for_pairs(const Ranked& wish) const;
  void make(const Ranked& wish, std::vector<LevelDecision::Change>& changes);

  std::span<const LevelCandidate> candidates_;
  const PolicySettings& settings_;
  const StepOverhead& overhead_;
  double room_ = kInfinity;                  // left of the budget, in its unit
  FullBill stays_full_;                      // of those that are full for now
  std::vector<float> price_of_pairs_;        // of each candidate that is full, or is to be
  std::vector<char> goes_down_;              // of each candidate: leaves the full level, or changes below it
  std::array<std::int64_t, kRungs> places_;  // for more bodies on each rung; negative: too many there
  std::array<std::int64_t, kRungs> held_by_dwell_{};  // bodies on each rung that leave it after their dwell
  std::vector<Ranked> promote_at_once_, demote_at_once_, promote_, demote_;
  LevelDecision decision_;
};

}  // namespace lodestone
