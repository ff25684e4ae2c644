// Drops by each method against the truth's (comparison.h): the score of each beside the noise floor, and its
// cost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/compare/comparison.h"
#include "tools/compare/drop_trials.h"
#include "tools/compare/fidelity.h"
#include "tools/compare/impact_errors.h"

namespace lodestone {

struct DropComparisonSettings : ComparisonSettings {
  DropComparisonSettings()
      : ComparisonSettings{.methods = {"full", "full_1", "hull", "spheres7", "sphere", "statistical"}} {}
  int trials = 300;  ///< ≥ 2
  TruthSettings truth = {};
};

struct DropRow : MethodAtStep {
  std::optional<ScoreWithInterval> score = {};  ///< none where left out
  std::optional<double> ns_per_body_step = {};
  std::vector<DropObservation> drops = {};
  std::optional<ImpactErrors> first_impacts = {};  ///< against truth from the same starts

  /// Over all drops: how often the signature was asked for what lies outside of what was measured.
  std::int64_t table_extrapolations() const;
};

struct DropComparison {
  std::string shape = {};
  int trials = 0;
  ScoreWithInterval floor = {};
  int truth_substeps = 0;                         ///< in 1/60 s
  std::optional<double> truth_push_m_per_s = {};  ///< as in TruthSettings
  std::vector<DropObservation> truth_a = {}, truth_b = {};
  std::vector<DropRow> rows = {};
};

/// Interrupted (tools/interrupt.h) where the truth is not whole.
DropComparison compare_drops(const DropJob& job, const DropComparisonSettings& settings);

}  // namespace lodestone
