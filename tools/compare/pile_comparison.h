// Piles by each method against the truth's (comparison.h).
//
// The truth is ODE in steps of .49 ms, as for drops: dWorldStep while few contacts hang together, else
// QuickStep, since dWorldStep's time grows with the cube of them (30 boxes in a bin: a quarter of an hour).
// QuickStep's friction follows the pressure of the moment, dWorldStep's that of a frictionless impact: so
// single bodies are answered as drops are, heaps as nearly as ODE can. How near that is, `check_truth` shows:
// the truth itself done finer, as rows beside the methods.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/compare/comparison.h"
#include "tools/compare/pile_trials.h"

namespace lodestone {

struct PileComparisonSettings : ComparisonSettings {
  PileComparisonSettings() : ComparisonSettings{.methods = {"full", "full_1", "statistical"}} {}
  PileConditions conditions;
  int piles = 6;                              ///< of each
  std::vector<std::string> check_truth = {};  ///< some of finer_truth_names()
};

/// Means over a batch, greatest values where the name says so, beside the truth.
struct PileFigures {
  double ke_l1 = 0;  ///< Σ |mean kinetic energy − truth's| / Σ truth's, over the samples
  double sleep_time_s = 0, sleep_time_error = 0;  ///< error: relative to the truth
  double mean_height_m = 0, mean_height_error = 0;
  double max_penetration_m = 0, penetration_over_size = 0;
  double end_penetration_over_size = 0;     ///< of all piles
  double median_penetration_over_size = 0;  ///< mean over the piles
  double energy_rise = 0;                   ///< greatest, over the energy at the start
  int hovering = 0, escaped = 0;            ///< of all piles together
};

struct PileRow : MethodAtStep {
  std::optional<PileFigures> figures = {};  ///< none where left out
  double momentum_residual = 0;
  std::optional<double> ns_per_body_step = {};  ///< none where not measured
  std::vector<PileObservation> piles = {};
};

struct PileComparison {
  std::string shape = {};
  PileConditions conditions = {};
  int pile_count = 0;
  int truth_substeps = 0, truth_iterations = 0;
  PileFigures truth = {}, floor = {};  ///< batch A beside itself; B beside A
  std::vector<PileObservation> truth_a = {}, truth_b = {};
  std::vector<PileRow> rows = {};
};

/// ODE as in this file's head, stepped as for drops.
Method make_pile_truth(const DropJob& job);

/// half_step: in twice as many steps; iterations: QuickStep with four times as many; direct: dWorldStep
/// however many contacts hang together, which is for few bodies.
std::vector<std::string> finer_truth_names();
/// That truth, named truth_NAME. Throws InputError for another name.
Method make_finer_truth(const DropJob& job, const std::string& name);

/// Neither empty.
PileFigures compare_with_truth(std::span<const PileObservation> truth, std::span<const PileObservation> piles,
                               const Shape& shape);

/// As compare_drops where it is interrupted. Throws InputError for an unknown method and for a bin too narrow
/// for one body.
PileComparison compare_piles(const DropJob& job, const PileComparisonSettings& settings);

}  // namespace lodestone
