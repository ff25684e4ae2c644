// Which full bodies motors move, or forces on those that they are joined to: what sleeps in their way or on
// them is woken (CarriedBodies), however slowly they go.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/cross_level.h"
#include "reference/disjoint_sets.h"
#include "reference/state_archive.h"

namespace lodestone {

class DrivenBodies {
 public:
  /// Marks those of a step of `dt` seconds; before what joints give besides holding is among their forces.
  /// One that a motor does not move is marked for a second, since who holds it up may sleep; from then on it
  /// is held by what does not give way.
  void mark(Neighborhood& neighborhood, const Vec3& gravity, double dt);
  void archive(StateArchive& a) { a(motors_); }

 private:
  void mark_pulled(Neighborhood& neighborhood, const Vec3& gravity);
  struct Motor {
    std::uint32_t owner = 0;  // FullNeighbor::owner of what it is on
    double speed = 0.0;       // m/s, that it asks for
    double held_s = 0.0;
  };
  std::vector<Motor> motors_, before_;  // by ascending owner
  DisjointSets joined_;                 // of neighbours, by joints
  std::vector<bool> pulls_;             // by neighbour
};

}  // namespace lodestone
