// Directions by the cells of a cube's faces: what is looked up by direction is kept by cell.
#pragma once

#include "reference/geometry.h"

namespace lodestone {

/// 6 × `side` × `side` cells.
class CubeMap {
 public:
  CubeMap() = default;
  explicit CubeMap(int side) : side_(side) {}

  int size() const { return 6 * side_ * side_; }
  /// Of a direction of any length; zero or not finite: some cell.
  int cell_of(const Vec3& direction) const;
  /// A direction of any length, and of any in the cell how far its unit vector is from this one's, at most.
  Vec3 middle_of(int cell) const { return direction_in(cell, 0.5, 0.5); }
  double find_reach(int cell) const;

 private:
  Vec3 direction_in(int cell, double along_u, double along_v) const;

  int side_ = 0;
};

}  // namespace lodestone
