// What does not move and everything rests on.
#pragma once

#include <vector>

#include "lod/ground/static_solids.h"
#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// All x with normal·x ≤ offset are solid. `normal` has unit length.
struct HalfSpace {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;  ///< m
  MaterialId material = 0;
  double height_of(const Vec3& point) const { return normal.dot(point) - offset; }
};

struct StaticGround {
  std::vector<HalfSpace> planes;
  StaticSolids solids;  ///< of boxes and meshes: met by `support` only
};

}  // namespace lodestone
