// What hangs together in a crowd, directly or through others, and how it is to be solved.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"
#include "reference/disjoint_sets.h"

namespace lodestone {

enum class IslandKind : std::uint8_t {
  small,   ///< of one body that moves, or of few points: each by itself, with ODE's bound on friction
  uneven,  ///< with bodies of which one weighs twelve times another that it touches: ODE's bound and more
           ///< sweeps
  great,   ///< any other, and what is left awake of such a heap: friction is bounded by the impulses as they
           ///< are
};

class CrowdIslands {
 public:
  void find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds);
  IslandKind kind_of(std::size_t manifold) const { return kinds_[manifold]; }
  /// The body that stands for the island of a manifold.
  std::int32_t island_of(std::size_t manifold) const { return island_of_[manifold]; }
  /// Whether a body that moves is in a great island, or on what sleeps in one.
  bool in_great_heap(std::int32_t body) {
    const Island& island = islands_[std::size_t(sets_.root_of(body))];
    return island.on_great_heap || kind_of(island) == IslandKind::great;
  }
  /// Greatest ratio of the masses of two that touch in the island of a manifold.
  double unevenness_of(std::size_t manifold) const {
    return double(islands_[std::size_t(island_of_[manifold])].unevenness);
  }
  /// The same of all great islands; 1: there are none.
  double most_uneven_of_great() const { return most_uneven_of_great_; }

 private:
  struct Island {
    std::uint32_t points = 0;
    bool on_great_heap = false;  // touches what sleeps in one
    float unevenness = 0.0F;     // greatest ratio of the masses of two that touch; 0: one body alone
  };
  IslandKind kind_of(const Island& island) const;

  DisjointSets sets_;            // of bodies
  std::vector<Island> islands_;  // of each body, where it stands for its island
  std::vector<std::int32_t> island_of_;
  std::vector<IslandKind> kinds_;
  double most_uneven_of_great_ = 1.0;
};

}  // namespace lodestone
