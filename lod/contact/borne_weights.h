// What new contacts bear, before any step has solved them: a first guess for the solver, without which the
// weight of a tower that was built, not poured, goes down it by one body in a sweep, and crushes it first.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/crowd_solver.h"

namespace lodestone {

class BorneWeights {
 public:
  /// Sets `guess` of the points of manifolds that are not known, but rest, in a step of `step` seconds in
  /// which gravity adds `fall` (m/s) to velocities: each body hands on, from above, its weight and what lies
  /// on it, less what known contacts bear of that, in equal parts to each such point below. Bodies that lie
  /// on each other in a circle get none.
  void guess(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
             std::span<CrowdPoint> points, const Vec3& fall, double step);

 private:
  /// A new manifold, from above: who lies on whom.
  struct Support {
    std::uint32_t manifold = 0;
    std::int32_t upper = -1, lower = -1;  // −1: the ground, or what nothing moves
    std::int32_t next = -1;               // of the same upper body
  };
  struct Place {
    double weight = 0.0;              // N s: not yet borne by anything below
    std::int32_t below = -1;          // its first support
    std::uint32_t points_below = 0;   // of all of its supports
    std::uint32_t awaited_above = 0;  // supports on it that have not handed on theirs
  };
  void find_supports(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                     std::span<const CrowdPoint> points, double step);
  void hand_on(std::span<const CrowdManifold> manifolds, std::span<CrowdPoint> points);

  Vec3 up_ = Vec3::UnitZ();
  double fall_ = 0.0;
  std::vector<Support> supports_;
  std::vector<Place> places_;  // of each body
  std::vector<std::int32_t> ready_;
};

}  // namespace lodestone
