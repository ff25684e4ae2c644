// The decision of a step: which rung each body should have, from what a policy says and what dwell, caps and
// room allow. Pure: no simulation here.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/manager/level_candidate.h"
#include "lod/manager/remoteness.h"
#include "lod/manager/views.h"
#include "lod/policy.h"

namespace lodestone {

/// What a budget has to bear besides the candidates, in the same unit.
struct StepOverhead {
  double others = 0.0;                  ///< whatever is no candidate's
  double margin = 0.0;                  ///< over the prediction: that it is likely to err by, as a part of it
  std::array<double, kRungs> change{};  ///< once, of a change to each rung
  /// Of full bodies that may meet, of weight 1; half of it where both sleep: all that wakes at once may take
  /// twice the budget.
  double pair = 0.0;
  /// Once, where there is such a pair that is awake, for what the dearest of them may take in a bad step.
  double spike = 0.0;
  bool pauses = false;  ///< none goes up but who must (change_pause.h)
};

struct LevelDecision {
  struct Change {
    std::int32_t candidate = 0;
    Rung to = Rung::support;
    friend bool operator==(const Change&, const Change&) = default;
  };
  /// Forced ones, newcomers and demotions that bring the cost back within the budget, or those on a rung
  /// within their limit (of bodies awake, then of sleepers, farthest first), come first and are not limited;
  /// of the rest at most max_transitions_per_frame, promotions (nearest first) and demotions (farthest first)
  /// by turns, and as exchanges where each waits for the other's place.
  std::vector<Change> promote, demote;
  std::vector<Rule> reasons;  ///< one per candidate
  int sent_back = 0;          ///< of `demote`: by the budget, though they had just changed
};

/// Without viewpoints no body is full that need not be.
LevelDecision choose_levels(std::span<const LevelCandidate> candidates, const Views& views,
                            const PolicySettings& settings, const StepOverhead& overhead = {});

// Which bodies may be left out of the candidates without any change to the decision. Under a policy of
// distances or sizes: statistical ones that stay_put. Under a budget: those that sleep at a greater
// rank_distance than reach_of_full. Under an error budget: statistical ones that sleep.

/// The rank distance up to which a budget has room for full bodies, infinite where it has room for all. Every
/// body that is full or must be is among the candidates.
double reach_of_full(std::span<const LevelCandidate> candidates, const Views& views,
                     const PolicySettings& settings, const StepOverhead& overhead);

/// Whether it counts work in place of time.
bool counts_work(const PolicySettings& settings);
/// In ms or in work units; a policy that has one.
double budget_of(const PolicySettings& settings);

}  // namespace lodestone
