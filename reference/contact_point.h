// Where two bodies touch.
#pragma once

#include "reference/geometry.h"

namespace lodestone {

/// `normal` (unit) points into the first body; moved along it by `depth` (m), the first body is clear.
struct ContactPoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double depth = 0.0;
  /// m/s along the normal, of the surface met; what bounces leaves it 1 + e times as fast.
  double lift = 0.0;
  double above = 0.0;  ///< m, by which it has not come down to it yet; then `depth` is 0
};

}  // namespace lodestone
