// Methods against the truth, drop by drop: the score of each beside the noise floor, and its cost.
//
// Two batches of truth with different starts, A and B, give the noise floor: B scored against A. A method
// takes the starts of B and is scored against A, too. So a method that equals the truth scores the floor
// exactly, and what it scores above the floor is its own error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/compare/drop_trials.h"
#include "tools/compare/fidelity.h"
#include "tools/compare/impact_errors.h"

namespace lodestone {

struct DropComparisonSettings {
  int trials = 300;                               ///< ≥ 2
  std::vector<double> dt_s = {kObservationStep};  ///< steps of the methods
  std::vector<std::string> methods = {"full", "full_1", "hull", "spheres7", "sphere", "statistical"};
  SignatureSettings measuring = {};  ///< of the signature of `statistical`; its law is the job's
  std::uint64_t seed = 1;
  int threads = 0;    ///< 0: all cores
  bool costs = true;  ///< measure them, too
  Progress progress;
};

/// One method at one step.
struct DropRow {
  std::string method, model;  ///< model "" for ODE
  double dt_s = kObservationStep;
  int substeps = 1;
  std::optional<ScoreWithInterval> score = {};  ///< none where left out
  std::optional<double> ns_per_body_step = {};
  std::string reason = {};  ///< why left out
  std::vector<DropObservation> drops = {};
  std::optional<ImpactErrors> first_impacts = {};  ///< against truth from the same starts

  /// Over all drops: how often the signature was asked for what lies outside of what was measured.
  std::int64_t table_extrapolations() const;
};

struct DropComparison {
  std::string shape = {};
  int trials = 0;
  ScoreWithInterval floor = {};
  int truth_substeps = 0;  ///< in 1/60 s
  std::vector<DropObservation> truth_a = {}, truth_b = {};
  std::vector<DropRow> rows = {};  ///< by method, then by step
};

/// Where the program is interrupted (tools/interrupt.h) the rows that are whole; Interrupted where the truth
/// is not.
DropComparison compare_drops(const DropJob& job, const DropComparisonSettings& settings);

}  // namespace lodestone
