// When full bodies fall asleep that statistical ones press on: ODE lets none sleep that its own contacts or
// joints do not hold up, and of such a heap it knows a part. Here those that hang together fall asleep at
// once, as soon as all have been still for as long as ODE asks; by the means of their velocities, since what
// is solved on two levels in turn trembles.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/cross_level.h"
#include "reference/disjoint_sets.h"
#include "reference/state_archive.h"

namespace lodestone {

class HeldBodies {
 public:
  /// Before the statistical level's step: who was woken since the last one has not been still.
  void note_woken(const Neighborhood& neighborhood);
  /// After it, for a step of `dt` seconds: whether it is to fall asleep now, of each of the full level's
  /// members. Jointed ones sleep by ODE's law.
  const std::vector<bool>& find_still(const Levels& levels, const Neighborhood& neighborhood, double dt);
  void archive(StateArchive& a) { a(still_); }

 private:
  /// Bodies that hang together, by contacts, but not through what is kinematic.
  struct Set {
    bool pressed = false;    // by a statistical body
    bool moved = false;      // one is carried, or lies where somebody waits to become full
    bool has_awake = false;  // one has not been still for long enough
  };
  struct Still {
    std::uint32_t owner = 0;                               // FullNeighbor::owner
    Vec3 velocity = Vec3::Zero(), turning = Vec3::Zero();  // m/s, rad/s: means
    double still_s = 0.0;
    bool asleep = false;
    void archive(StateArchive& a) { a(owner, velocity, turning, still_s, asleep); }
  };
  void find_sets(const Levels& levels, const Neighborhood& neighborhood);
  Set& set_of(std::size_t neighbor) { return sets_[std::size_t(joined_.root_of(std::int32_t(neighbor)))]; }

  std::vector<Still> still_, before_;  // of those in pressed sets, by ascending owner
  DisjointSets joined_;                // neighbours
  std::vector<Set> sets_;              // by root
  std::vector<bool> falls_asleep_;     // by member
};

}  // namespace lodestone
