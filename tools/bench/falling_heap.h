// Many bodies that fall into one heap.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

struct FallingHeap {
  /// Of the upright cylinder, twice as high as wide, out of which they fall at rest onto z = 0.
  double radius_m = 0.0;
  std::vector<RigidState> starts;  ///< turned at random, none touching another
};

FallingHeap make_falling_heap(int bodies, double body_radius_m, std::uint64_t seed);

}  // namespace lodestone
