// A signature whose tables come from measured collisions and rests (section 5.3), and ODE's own trials in
// that form.
#pragma once

#include "signature/measure/measure.h"
#include "signature/measure/measured_trials.h"

namespace lodestone {

/// What measured trials gave.
struct TrialCoverage {
  std::int64_t cells = 0, measured_cells = 0;  ///< of the tables; the other cells keep what ODE gave
  /// `left_out`: away from the plane, without motion, or with an answer a thousand times as fast.
  std::int64_t collisions = 0, left_out = 0;
  std::int64_t rests = 0;  ///< 0: the rest poses are ODE's
};

/// Collisions whose speed unit √(v² + R²ω²) is below this belong to the table without bounce, m/s: at most √2
/// times it approaches, which is ODE's bounce_vel.
inline constexpr double kFastestWithoutBounce = 0.035;

/// The signature of `shape` with the responses of `trials` in the cells that they fall into, each with all
/// the trials of its cell, and their rest poses. What they do not tell is ODE's: collision heights and
/// approaches (which are geometry), settling clips, cells without a row, held-out trials. Energy ratios of
/// rows are left out of the certificate. `velocities` of `trials` are those of a body of `shape`'s own size.
Signature make_signature_from_trials(const Shape& shape, const SignatureSettings& settings,
                                     const MeasuredTrials& trials, const MeasureOptions& options = {},
                                     TrialCoverage* coverage = nullptr);

/// The trials behind `measurement`, run again: every collision of its tables, at the size of `shape`, and
/// every rest. Those without bounce are given at speeds below kFastestWithoutBounce.
MeasuredTrials list_trials(const Shape& shape, const SignatureSettings& settings,
                           const Measurement& measurement, int threads = 0);

}  // namespace lodestone
