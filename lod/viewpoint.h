// From where a world is looked at: what the policies measure distances and sizes from.
#pragma once

#include <numbers>
#include <optional>

#include "reference/geometry.h"

namespace lodestone {

struct Viewpoint {
  Vec3 position = Vec3::Zero();        ///< m, within 1e12 of the origin
  std::optional<Vec3> direction = {};  ///< of sight, of any length but 0; none: it sees all around
  /// Of any length but 0, roughly: what is along the direction of sight is left out.
  Vec3 up = Vec3::UnitZ();
  /// From the lower edge of the picture to the upper, in (0, π).
  double vertical_fov_rad = std::numbers::pi / 3;
  double height_px = 1080.0;   ///< of the picture, > 0
  double aspect = 16.0 / 9.0;  ///< its width over its height, > 0
};

}  // namespace lodestone
