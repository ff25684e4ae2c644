// From where the world is looked at: policies measure distances and sizes in the picture from viewpoints.
#pragma once

#include <numbers>
#include <optional>

#include "reference/geometry.h"

namespace lodestone {

/// A camera. What is out of its range throws InputError.
struct Viewpoint {
  Vec3 position = Vec3::Zero();        ///< m, each coordinate within 1e12 of 0
  std::optional<Vec3> direction = {};  ///< of sight, of any length but 0; none: it sees all around
  /// Roughly upward in the picture, of any length but 0; only its part across the direction of sight counts.
  Vec3 up = Vec3::UnitZ();
  /// The angle between the lower and the upper edge of the picture, > 0 and < π.
  double vertical_fov_rad = std::numbers::pi / 3;
  double height_px = 1080.0;   ///< the picture's height, > 0
  double aspect = 16.0 / 9.0;  ///< the picture's width over its height, > 0
};

}  // namespace lodestone
