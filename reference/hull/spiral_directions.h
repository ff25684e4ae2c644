// Directions even over the sphere.
#pragma once

#include <numbers>

#include "reference/geometry.h"

namespace lodestone {

/// The `i`-th of `n` unit vectors (Fibonacci's spiral).
inline Vec3 spiral_direction(int i, int n) {
  const double z = 1.0 - (2.0 * i + 1.0) / n, angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0)),
               r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace lodestone
