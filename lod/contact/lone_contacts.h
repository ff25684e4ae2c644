// The contacts of bodies that touch nothing that moves, each body by itself: with friction bounded as in ODE,
// by the normal impulses that there would be without any, to a result that hangs on no other body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"
#include "lod/jobs.h"

namespace lodestone {

class LoneContacts {
 public:
  /// Which manifolds are theirs.
  void find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds);
  bool holds(std::size_t manifold) const { return is_lone_[manifold] != 0; }
  /// As solve_contacts, with its frictionless bound; `settings` say what bounces. Of the points that are not
  /// theirs nothing changes.
  void solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
             const JobRunner& jobs);

 private:
  static bool moves(std::span<const SolverBody> bodies, std::int32_t body) {
    return body >= 0 && bodies[std::size_t(body)].inverse_mass > 0.0;
  }
  /// A manifold, by its body that moves.
  struct Own {
    std::int32_t body;
    std::uint32_t manifold;
  };
  static void solve_one(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                        std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                        std::span<const Own> own);

  std::vector<char> among_others_;    // of each body: whether it touches another that moves
  std::vector<char> is_lone_;         // of each manifold
  std::vector<Own> own_;              // of lone bodies, by body
  std::vector<std::uint32_t> first_;  // of each lone body's manifolds, in `own_`; one more
};

}  // namespace lodestone
