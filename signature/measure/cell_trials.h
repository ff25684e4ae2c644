// The trials of one cell of a table, and of one held-out condition.
#pragma once

#include <span>

#include "signature/measure/collision_trial.h"
#include "signature/measure/measurement.h"

namespace lodestone {

/// How the cells of a table are sampled.
struct CellSampling {
  std::uint64_t seed = 1;
  int trials = 60;     ///< of each cell, unless `error` is asked for
  double error = 0.0;  ///< above 0: batches until no mean has a greater standard error, over s
  int most_trials = 4000;
  bool every_psi = true;  ///< ψ is drawn; else the centre's
  bool keep_responses = false;
};

/// How a trial starts.
struct CellTrial {
  CollisionConfiguration configuration;
  Quat orientation = Quat::Identity();
};

/// Trial k of cell `cell`: its orientation (and ψ) drawn from the key (seed, cell, k).
CellTrial cell_trial(const CollisionConfiguration& center, std::int64_t cell, std::uint32_t k,
                     const CellSampling& sampling);

/// The mean, spread and count of these responses; the rest of the unit is left as it is made.
CellUnit make_cell_unit(std::span<const Response> responses);

/// Trial k of cell `cell` has its orientation (and ψ) from the key (seed, cell, k), so a cell is the same
/// wherever it is measured.
CellUnit measure_cell(CollisionTrial& trial, const CollisionConfiguration& center, std::int64_t cell,
                      const CellSampling& sampling);

/// At each condition: enough to tell the error of a mean from the spread of the trials.
inline constexpr int kHeldOutTrials = 16;

/// Trials at `c`, from the keys (seed, number, 0 …); with `every_psi` each draws a ψ of its own.
HeldOutUnit measure_held_out(CollisionTrial& trial, const CollisionConfiguration& c, std::int64_t number,
                             std::uint64_t seed, bool every_psi);

/// Condition `number`: random over all that a table covers.
CollisionConfiguration held_out_condition(std::int64_t number, std::uint64_t seed);
CollisionConfiguration held_out_condition(const SpeedTable& table, std::int64_t number, std::uint64_t seed);

}  // namespace lodestone
