// What it costs to find the near pairs among n balls: by the cells of the statistical level, and by what one
// would use instead.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signature/signature_source.h"
#include "tools/bench/ball_layouts.h"

namespace lodestone {

struct BroadPhaseSettings {
  std::vector<int> bodies = {1'000, 10'000, 100'000};
  std::vector<std::string> layouts = {"layer", "pile", "sparse", "mixed", "line", "outliers"};
  int threads = 1;  ///< of the cells; the others run on one
  int steps = 9;    ///< of 1/60 s: the median counts
  /// m/s, of every ball: methods that keep what they know from step to step take more time the faster they
  /// are.
  double speed = 1.0;
  double row_seconds = 20.0;  ///< an alternative that would take longer for all steps is left out
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Nanoseconds are those of a step, over the number of balls: of the processor where one thread works, else
/// of the clock.
struct BroadPhaseRow {
  std::string layout = {};
  int bodies = 0, threads = 1;
  double fill_ns = 0.0, pairs_ns = 0.0;  ///< of the cells: taking the balls in, finding the pairs
  double pairs_per_body = 0.0;
  std::int64_t cells = 0;
  int grids = 0;                ///< one for each size of cell
  bool flat = false;            ///< the cells of the finest are one layer
  double bytes_per_body = 0.0;  ///< held by the cells
  std::optional<double> ode_hash_ns = {}, ode_sweep_ns = {}, bullet_tree_ns = {};  ///< the whole of it
  std::optional<double> times_less = {};  ///< the fastest of those over the cells
  /// Hash, sweep, tree; all: each ball tried with each; -N: who missed N pairs itself.
  std::string checked_by = {};
  std::string fault = {};  ///< what the cells did wrong; else empty
};

/// A row for each number of bodies and layout.
std::vector<BroadPhaseRow> bench_broad_phase(const BroadPhaseSettings& settings);

/// Every pair of balls that meet, in order: each tried with each other.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_pairs_plainly(const Balls& balls);

}  // namespace lodestone
