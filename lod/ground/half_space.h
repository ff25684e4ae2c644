// A plane of the ground.
#pragma once

#include "lod/ground_id.h"
#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// All x with normal·x ≤ offset are solid. `normal` has unit length.
struct HalfSpace {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;  ///< m
  MaterialId material = 0;
  GroundId id = {};  ///< of what it is a plane or a face of
  double height_of(const Vec3& point) const { return normal.dot(point) - offset; }
};

}  // namespace lodestone
