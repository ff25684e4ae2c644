// Whether a budget is kept where it is hardest to: bodies fall into a heap around a viewpoint that jumps.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "scenes/budget_figures.h"
#include "signature/signature_source.h"

namespace lodestone {

inline constexpr double kJumpEvery_s = 2.0;
inline constexpr int kNearest = 50;

struct BudgetBenchSettings {
  int bodies = 2'000;
  std::vector<double> budgets_ms = {4.0, 8.0, 16.0};
  double work = 4'000.0;  ///< units of one more budget, run on one thread and on two, twice each; 0: none
  int steps = 600;        ///< of 1/60 s
  int threads = 1;        ///< under the budgets of time
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Bunnies of .2 m, restitution .3, friction .5, all as the policy says. The viewpoint stands at six tenths
/// of the heap's radius, .5 m above the ground, every two seconds at another place. Counted from
/// kFirstBudgetStep on.
struct BudgetBenchRow {
  BudgetFigures figures;
  int threads = 1;
  std::array<int, kRungs> least{}, most{};  ///< bodies at the end of a step, by Rung
  double nearest = 0.0;  ///< of the n nearest bodies, where n are full, the part that is full: mean of steps
  double nearest_settled = 0.0;  ///< the same without the half second after a jump
  /// Of the kNearest nearest, those that are not full, by their rung and why they have it: mean of steps.
  std::map<std::string, double> waiting;
  std::uint64_t state_hash = 0;
};

/// 99 % within 1.1 times the budget, at most 1 step in 100 over it, none over twice it. Of a budget of work
/// always: nothing is asked of its time.
bool is_kept(const BudgetFigures& figures);

/// The budgets of time in their order, then the four runs of the budget of work.
std::vector<BudgetBenchRow> bench_budget(const BudgetBenchSettings& settings);

/// That the runs of a budget of work ended in the same state.
bool repeats_exactly(const std::vector<BudgetBenchRow>& rows);

}  // namespace lodestone
