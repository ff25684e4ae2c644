// Rays against boxes and triangles.
#pragma once

#include <array>
#include <optional>

#include "reference/geometry.h"

namespace lodestone {

/// Where the ray is within the box made larger by `margin` m on all sides, if before `length` m (Ericson,
/// Real-time collision detection, 2005: 5.3.3).
bool enters_box(const Eigen::AlignedBox3d& box, double margin, const Vec3& from, const Vec3& direction,
                double length);

/// m, at most `length`: along a ray of unit `direction` to where it meets a triangle, counter-clockwise seen
/// from outside, from there (Möller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997).
std::optional<double> meet_front(const std::array<Vec3, 3>& triangle, const Vec3& from, const Vec3& direction,
                                 double length);
/// The same from inside.
inline std::optional<double> meet_back(const std::array<Vec3, 3>& t, const Vec3& from, const Vec3& direction,
                                       double length) {
  return meet_front({t[0], t[2], t[1]}, from, direction, length);
}

}  // namespace lodestone
