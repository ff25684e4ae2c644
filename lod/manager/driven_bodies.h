// Which full bodies motors move: what sleeps in their way is woken (CarriedBodies), however slowly they go.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/cross_level.h"
#include "reference/state_archive.h"

namespace lodestone {

class DrivenBodies {
 public:
  /// Marks those of a step of `dt` seconds. One that a motor does not move is marked for a second, since who
  /// holds it up may sleep; from then on it is held by what does not give way.
  void mark(Neighborhood& neighborhood, double dt);
  void archive(StateArchive& a) { a(motors_); }

 private:
  struct Motor {
    std::uint32_t owner = 0;  // FullNeighbor::owner of what it is on
    double speed = 0.0;       // m/s, that it asks for
    double held_s = 0.0;
  };
  std::vector<Motor> motors_, before_;  // by ascending owner
};

}  // namespace lodestone
