// The contacts of a whole crowd at once, each island of what hangs together as its kind asks for.
#pragma once

#include <memory>
#include <span>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"
#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"

namespace lodestone {

class CrowdSolver {
 public:
  explicit CrowdSolver(Simd simd = find_simd());
  ~CrowdSolver();

  /// Friction is bounded without regard to itself for islands of few points, and, with more sweeps, where
  /// bodies that hang together differ in mass by much; by the impulses as they are elsewhere. The
  /// points of a manifold follow each other in `points`.
  void solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
             const JobRunner& jobs);
  /// Of the last call: manifolds through which a blow went on (ImpactWaves). What they gave is no support.
  std::span<const std::uint32_t> struck() const;

 private:
  struct Work;  // arrays that are kept between steps
  std::unique_ptr<Work> work_;
};

}  // namespace lodestone
