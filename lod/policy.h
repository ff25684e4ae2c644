// Which rung each body should have: by distance from the viewpoints, or by what a step may cost.
#pragma once

#include <limits>
#include <variant>

namespace lodestone {

/// Full within `full_within` metres (times importance) of the nearest viewpoint, `support` within `support_within`, `tables` beyond; a lower rung again only beyond
/// the distance times (1 + hysteresis).
struct DistancePolicy {
  double full_within = 4.0;  ///< m
  double support_within = std::numeric_limits<double>::infinity();  ///< m
};

/// What a whole step may cost, in processor time of the calling thread: choice, transfer, all three rungs and what they have to do with each other. The nearest bodies
/// are full, the next ones `support`, the others `tables`, as many as are predicted to fit; the prediction is learnt from measured steps, so the levels differ from run to run.
struct BudgetPolicy {
  double budget_ms = 4.0;
};

/// The same with work that is counted, not timed: the same levels in every run and on every machine. A unit is about a microsecond (see RungCost::work).
struct WorkPolicy {
  double budget_work = 4000.0;
};

inline constexpr int kUnlimited = std::numeric_limits<int>::max();

struct PolicySettings {
  std::variant<DistancePolicy, BudgetPolicy, WorkPolicy> policy;
  double hysteresis = 0.1;            ///< fraction of the distance
  int min_dwell_frames = 30;          ///< a body keeps a new rung at least this long
  int max_transitions_per_frame = 4;  ///< nearest first; the rest wait their turn
  int most_full = kUnlimited;         ///< bodies that the policy makes full, at any time: the nearest
  int most_support = kUnlimited;      ///< and `support`
};

}  // namespace lodestone
