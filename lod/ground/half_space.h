// A plane of the ground.
#pragma once

#include "lod/ground_id.h"
#include "reference/geometry.h"
#include "reference/material.h"

namespace lodestone {

/// ODE's, of what it is: a manager's own ground has all.
struct GroundBits {
  unsigned category = ~0u, collide = ~0u;
  bool callers = false;  ///< a geom of the caller's
};

/// All x with normal·x ≤ offset are solid. `normal` has unit length.
struct HalfSpace {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;  ///< m
  MaterialId material = 0;
  GroundId id = {};      ///< of what it is a plane or a face of
  GroundBits bits = {};  ///< a face has all: who meets its part is asked there
  double height_of(const Vec3& point) const { return normal.dot(point) - offset; }
};

}  // namespace lodestone
