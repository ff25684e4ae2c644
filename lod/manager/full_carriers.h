// Kinematic bodies that carry or push full ones: these are full themselves, so that one solver has all that
// such a body bears. A heap of full bodies on a statistical one is solved twice, each time with what the
// other gave it a step ago, and never quite comes to rest. Simulated, a kinematic body is not, on any rung.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/levels.h"
#include "lod/statistical/full_neighbor.h"
#include "reference/state_archive.h"

namespace lodestone {

class FullCarriers {
 public:
  explicit FullCarriers(const Levels& levels) : levels_(levels) {}

  /// Whether the full body is a manager's own: then its carrier is one from now on.
  bool take(const CarriedFull& touch);
  /// Whether it was taken, and some full body that is not kinematic is near it still.
  bool contains(std::uint32_t body);
  void forget(std::uint32_t body);
  void archive(StateArchive& a) { a(bodies_); }

 private:
  bool is_near_full(std::uint32_t body) const;

  const Levels& levels_;
  std::vector<std::uint32_t> bodies_;  // in order
};

}  // namespace lodestone
