// How near a method's drops are to the ground truth's: what is observed of a drop, and the score
// (tools/README.md). Every method, truth included, is observed alike: states sampled at 60 Hz, whatever its
// own step.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "tools/compare/drop_observation.h"

namespace lodestone {

/// The score's parts against truth, and their mean over those that are defined (`parts` of them). A part is
/// undefined where the truth does not vary in it, and rest time and rest poses also where fewer than a tenth
/// of the truth's drops come to rest (a sphere rolls for ever).
struct DropScore {
  double score = 0;
  int parts = 0;
  std::optional<double> w_bounces, w_rest_time, w_distance, w_peak, ke_w, tv;
};

struct ScoreWithInterval {
  DropScore value;
  /// 95 % bootstrap interval of the score, both samples drawn anew: the percentiles, moved so that the
  /// resamples' mean is the score. (A distance between resamples is greater than between the samples, by the
  /// noise of drawing: the percentiles alone may lie wholly above it. At the noise floor the interval remains
  /// up to √2 too wide.)
  std::array<double, 2> interval{};
};

/// Scores `method` against `truth`, neither empty. W: Wasserstein-1 over the truth's deviation; KEw: Σ_t
/// W1(KE_t) / Σ_t mean KE_t; TV: total variation over the rest-pose classes of the truth's drops and "none"
/// (not at rest, or farther than 12° from every class). Truth and method are sorted into the classes by the
/// same rule. `seed` feeds the bootstrap.
ScoreWithInterval score_drops(std::span<const DropObservation> truth, std::span<const DropObservation> method,
                              std::uint64_t seed = 1, int bootstrap_samples = 200);

}  // namespace lodestone
