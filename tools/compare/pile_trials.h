// Simulates a method's piles and observes them, and measures in passes of their own what they cost and
// whether momentum lasts.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/compare/pile_observation.h"
#include "tools/compare/pile_start.h"
#include "tools/methods/method_world.h"

namespace lodestone {

/// Which piles, and how they are stepped.
struct PileBatch {
  PileConditions conditions;
  int piles = 6;
  std::uint64_t seed = 1;  ///< of the starts: the same for every method that is to be compared
  double dt_s = 1.0 / 60.0;
  int threads = 0;  ///< 0: all cores; the result does not depend on it
};

/// `progress` is called with the fraction done, from one thread at a time.
std::vector<PileObservation> observe_piles(const DropJob& job, const Method& method,
                                           const PileOverlap& overlap, const PileBatch& batch,
                                           const std::function<void(double)>& progress = {});

/// Processor time of a body's step, ns, of the batch's first pile, on one thread, until `until_s`; asleep
/// bodies do not count.
double measure_ns_per_body_step(const DropJob& job, const Method& method, const PileBatch& batch,
                                double until_s);

/// The batch's bodies fly towards each other without ground and gravity for three seconds: the greatest
/// change of their momentum, over the sum of all bodies' own at the start.
double measure_momentum_residual(const DropJob& job, const Method& method, const PileBatch& batch);

}  // namespace lodestone
