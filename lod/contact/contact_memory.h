// The impulses of the last step's contacts, from which the solver starts: a pile at rest is then solved
// almost before the first sweep (warm starting; Catto, Iterative dynamics with temporal coherence, 2005).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/crowd_solver.h"
#include "lod/contact/pair_memory.h"
#include "lod/jobs.h"
#include "lod/statistical/step_lengths.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A step may solve sets of islands one after the other, each in substeps of its own: what the first substep
/// of a set recalls is of the last step, whichever set its bodies were in then.
class ContactMemory {
 public:
  /// Of `dt` seconds.
  void begin_step(double dt) { this_step_.clear(), shares_ = lengths_.begin(dt); }
  void begin_islands() { begun_ = false; }
  void end_islands();
  /// Where nothing was remembered in the step, as in one much shorter than those before, what was stays.
  void end_step();

  /// Sets `guess` of the points of a pair to what it had, each force going to the point that is nearest to
  /// where it was, as seen from the first body: points of a face come in any order. Says of its manifolds
  /// that they are known. `keys` holds one key per manifold, equal ones in a row; `step` is the length of
  /// this substep, s.
  void recall(std::span<const ContactKey> keys, std::span<CrowdManifold> manifolds,
              std::span<CrowdPoint> points, double step, const JobRunner& jobs);
  /// For the next substep of these islands, which forgets those before.
  void remember(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                std::span<const CrowdPoint> points, double step);

  void archive(StateArchive& a) { a(last_step_, lengths_); }

 private:
  struct Run {
    std::uint32_t begin, count;
  };
  struct Load {
    Eigen::Vector3f force, arm;  // N, on the first body; m, from its centre of mass
    float frictionless;          // N, as CrowdPoint has it
  };
  struct Loads {
    PairMemory place;  // in runs
    std::vector<Run> runs;
    std::vector<Load> loads;
    void clear() { place.clear(), runs.clear(), loads.clear(); }
    void archive(StateArchive& a) { a(place, runs, loads); }
  };
  Loads last_step_, this_step_, last_substep_;  // of all islands, of those that are done, of those in hand
  bool begun_ = false;                          // those in hand had a substep that is remembered
  StepLengths lengths_;
  StepLengths::Shares shares_;  // in this step

  /// Manifolds of a pair that was there before.
  struct Recalled {
    std::uint32_t first, end;  // manifolds
    std::int32_t place;        // in runs
  };
  std::vector<Recalled> recalled_;
};

}  // namespace lodestone
