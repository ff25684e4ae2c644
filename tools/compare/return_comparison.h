// Bodies that leave the view and return, against bodies that were full all the time: drops of the same
// distribution of starts, over which the viewpoint goes away and comes back.
#pragma once

#include <string>
#include <vector>

#include "tools/compare/drop_trials.h"

namespace lodestone {

struct ReturnSettings {
  int runs = 100;                                     ///< of each ensemble, ≥ 2
  double leave_s = 0.2;                               ///< when the viewpoint goes
  double away_s = 0.8;                                ///< and how long it stays away
  StatisticalModel away = StatisticalModel::support;  ///< the body's rung meanwhile
  bool published = false;                             ///< at `tables` the paper's model
  SignatureSettings measuring = {};                   ///< its law is the job's
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
  Progress progress;
};

/// One number of a run, compared between two ensembles.
struct ReturnMeasure {
  std::string name;
  double mean_full = 0, mean_returned = 0;
  /// Kolmogorov–Smirnov, or total variation for the rest pose: returned against full, and full against full
  /// from other starts.
  double distance = 0, floor = 0;
  /// A Kolmogorov–Smirnov distance that two ensembles of one distribution exceed in 5 % of cases; 0 for the
  /// rest pose.
  double critical = 0;
  double w1_over_deviation = 0,
         w1_floor = 0;  ///< Wasserstein-1 over the deviation among full ones; 0 for the rest pose
};

struct ReturnComparison {
  int runs = 0;
  double score = 0, score_floor = 0;    ///< as of `compare drop`, truth being the full ensemble
  double mean_rung_changes = 0;         ///< of a returned body
  double all_full_again = 0;            ///< part of the returned that were full at the end
  std::vector<ReturnMeasure> measures;  ///< distance, time to rest, bounces, rest pose
};

ReturnComparison compare_return(const DropJob& job, const ReturnSettings& settings);

}  // namespace lodestone
