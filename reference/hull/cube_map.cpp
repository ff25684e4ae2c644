#include "reference/hull/cube_map.h"

#include <algorithm>

namespace lodestone {

// The faces one after the other, 2 × axis + (1 on the negative side); of each, rows along the axis after
// next.
int CubeMap::cell_of(const Vec3& direction) const {
  const Vec3 size = direction.cwiseAbs();
  const int axis = size.x() >= size.y() ? (size.x() >= size.z() ? 0 : 2) : (size.y() >= size.z() ? 1 : 2);
  constexpr int kNext[] = {1, 2, 0}, kAfterNext[] = {2, 0, 1};
  const double half = 0.5 * side_, scale = half / size[axis];
  const auto along = [&](double coordinate) {
    const double cell = half + coordinate * scale;  // NaN where the direction is zero or not finite: cell 0
    return cell >= 0.0 && cell < side_ ? int(cell) : (cell >= side_ ? side_ - 1 : 0);
  };
  const int face = 2 * axis + (direction[axis] < 0.0);
  return (face * side_ + along(direction[kAfterNext[axis]])) * side_ + along(direction[kNext[axis]]);
}

Vec3 CubeMap::direction_in(int cell, double along_u, double along_v) const {
  const int u = cell % side_, v = cell / side_ % side_, face = cell / (side_ * side_), axis = face / 2;
  Vec3 direction;
  direction[axis] = face % 2 == 0 ? 1.0 : -1.0;
  direction[(axis + 1) % 3] = (u + along_u) * 2.0 / side_ - 1.0;
  direction[(axis + 2) % 3] = (v + along_v) * 2.0 / side_ - 1.0;
  return direction;
}

// The farthest is a corner.
double CubeMap::find_reach(int cell) const {
  const Vec3 middle = middle_of(cell).normalized();
  double reach = 0.0;
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0})
      reach = std::max(reach, (direction_in(cell, u, v).normalized() - middle).norm());
  return reach;
}

}  // namespace lodestone
