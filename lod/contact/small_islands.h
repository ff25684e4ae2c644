// Few bodies that hang together, each island of them by itself: with friction bounded as in ODE, by the
// normal impulses that there would be without any, to a result that hangs on no other body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_islands.h"
#include "lod/jobs.h"

namespace lodestone {

class SmallIslands {
 public:
  /// Which manifolds are theirs.
  void find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
            const CrowdIslands& islands);
  /// As solve_contacts, with its frictionless bound; `settings` say what bounces. Of the points that are not
  /// theirs nothing changes.
  void solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings, Simd simd,
             const JobRunner& jobs);

 private:
  /// A manifold, by its island.
  struct Own {
    std::int32_t island;
    std::uint32_t manifold;
  };
  /// Islands, each from its first manifold in `own_` to the next one's.
  void solve_some(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                  std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings, Simd simd,
                  std::span<const std::uint32_t> first);

  std::vector<Own> own_;                // by island
  std::vector<std::uint32_t> first_;    // of each island's manifolds, in `own_`; one more
  std::vector<std::int32_t> place_of_;  // of each body that moves: among those of its island
};

}  // namespace lodestone
