// The impulses of the last step's contacts, from which the solver starts: a pile at rest is then solved
// almost before the first sweep (warm starting; Catto, Iterative dynamics with temporal coherence, 2005).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/crowd_solver.h"
#include "lod/contact/pair_memory.h"
#include "lod/jobs.h"
#include "reference/state_archive.h"

namespace lodestone {

class ContactMemory {
 public:
  /// Sets `guess` of the points of a pair to what it had, each force going to the point that is nearest to
  /// where it was, as seen from the first body: points of a face come in any order. Says of its manifolds
  /// that they are known. `keys` holds one key per manifold, equal ones in a row; `step` is the length of
  /// this step, s.
  void recall(std::span<const ContactKey> keys, std::span<CrowdManifold> manifolds,
              std::span<CrowdPoint> points, double step, const JobRunner& jobs);
  /// Forgets what was before.
  void remember(std::span<const ContactKey> keys, std::span<const CrowdManifold> manifolds,
                std::span<const CrowdPoint> points, double step);

  void archive(StateArchive& a) { a(place_, runs_, loads_); }

 private:
  struct Run {
    std::uint32_t begin, count;
  };
  PairMemory place_;  // in runs_
  std::vector<Run> runs_;
  struct Load {
    Vec3 force, arm;  // N, on the first body; m, from its centre of mass
  };
  std::vector<Load> loads_;

  /// Manifolds of a pair that was there before.
  struct Recalled {
    std::uint32_t first, end;  // manifolds
    std::int32_t place;        // in runs_
  };
  std::vector<Recalled> recalled_;
};

}  // namespace lodestone
