// The contacts of a whole crowd at once: sequential impulses as in contact_solver.h, four manifolds side by
// side. Manifolds are coloured so that those of one colour share no body that moves (greedy colouring;
// Fratarcangeli, Tibaldo and Pellacini, Vivace, 2016): any number of them can be answered at a time, with one
// result.
#pragma once

#include <memory>
#include <span>

#include "lod/contact/contact_solver.h"
#include "lod/jobs.h"
#include "lod/simd/wide_loop.h"

namespace lodestone {

/// What two bodies, or a body and the ground, touch in: points with one normal.
struct CrowdManifold {
  std::int32_t first = 0, second = -1;  ///< indices of SolverBody; second −1: the ground
  Vec3 normal = Vec3::UnitZ();          ///< points into `first`
  ContactLaw law;
  std::uint32_t begin = 0, count = 0;  ///< its points
  bool known = false;                  ///< from the last step, which gives the guesses of its points
};

struct CrowdPoint {
  Vec3 arm_first = Vec3::Zero(),
       arm_second = Vec3::Zero();  ///< m, from each centre of mass to the shared point
  double gap = 0.0;                ///< m, negative where they overlap
  Vec3 guess = Vec3::Zero();       ///< N s, on `first`: what a resting contact starts from
  // Filled by the solver:
  Vec3 impulse = Vec3::Zero();  ///< N s, on `first`
  bool bounces = false;         ///< an impact, fast enough for restitution
  float impact_time = 0.0f;     ///< s, of one that bounces: when in the step its gap is closed
};

class CrowdSolver {
 public:
  explicit CrowdSolver(Simd simd = find_simd());
  ~CrowdSolver();

  /// As solve_contacts; with its frictionless bound, and more sweeps, where bodies that hang together differ
  /// in mass by much, without it elsewhere. The points of a manifold follow each other in `points`.
  void solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
             const JobRunner& jobs);

 private:
  struct Work;  // arrays that are kept between steps
  std::unique_ptr<Work> work_;
};

}  // namespace lodestone
