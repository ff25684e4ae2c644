// Simulates a method's drops and observes them, and measures in a pass of its own what they cost.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/compare/drop_observation.h"
#include "tools/methods/method_world.h"

namespace lodestone {

/// One body at a time over the plane, or what else the job has.
class DropWorld {
 public:
  /// `job` and `method` must outlive the world.
  DropWorld(const DropJob& job, const Method& method);

  /// Replaces the body by that of drop `trial`. What follows depends on (seed, trial) alone.
  MethodWorld& start(std::uint64_t seed, std::uint32_t trial);

 private:
  const DropJob& job_;
  MethodWorld world_;
};

/// Drops 0 … bodies − 1 in one world over the plane, too far apart to meet; `threads`: of the statistical
/// level.
MethodWorld make_many_drops(const DropJob& job, const Method& method, std::uint64_t seed, int bodies,
                            int threads = 1);

/// Which drops, and how they are stepped.
struct DropBatch {
  int trials = 300;
  std::uint64_t seed = 1;  ///< of the starts: the same for every method that is to be compared start by start
  double dt_s = kObservationStep;
  int threads = 0;  ///< 0: all cores; the result does not depend on it
};

/// Simulates drops 0 … trials − 1 for 10 s, or until a body has settled, and observes each at 60 Hz.
/// `progress` is called with the fraction done, from one thread at a time.
std::vector<DropObservation> observe_drops(const DropJob& job, const Method& method, const DropBatch& batch,
                                           const std::function<void(double)>& progress = {});

/// Processor time of a body's step, ns, over the steps in which it is awake, on one thread. ODE and Bullet:
/// one body at a time, up to the rest that `observed` found; the median of some of the batch's drops.
/// Statistical, on a plane: a thousand bodies in one manager, too far apart to meet, without the phases that
/// look for pairs; on other ground as the others.
double measure_ns_per_body_step(const DropJob& job, const Method& method, const DropBatch& batch,
                                std::span<const DropObservation> observed);

}  // namespace lodestone
