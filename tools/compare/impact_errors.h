// How far a method's first impacts are from the truth's, drop by drop from the same start: up to there
// nothing is chaotic yet. The unit is a tenth of the impulse, about the least error that viewers notice
// (Bounce Maps, 2017, citing O'Sullivan and others, 2003).
#pragma once

#include <optional>
#include <span>

#include "tools/compare/drop_observation.h"

namespace lodestone {

struct ImpactErrors {
  int impacts = 0;              ///< drops in which both saw one
  double impulse_median = 0.0;  ///< |J − J*| / |J*| in tenths: half of the impacts err by less
  double impulse_mean = 0.0;
  double unnoticed = 0.0;     ///< fraction of impacts whose impulse errs by at most one tenth
  double angle_deg = 0.0;     ///< median, between the velocities after it
  double speed_change = 0.0;  ///< mean of (|v| − |v*|) / |v*| after it: signed
};

/// `method` and `truth` have the same starts, one by one. None where no drop has an impact in both.
std::optional<ImpactErrors> measure_impact_errors(std::span<const DropObservation> truth,
                                                  std::span<const DropObservation> method);

}  // namespace lodestone
