// One convex solid of the ground.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "reference/hull/hull.h"
#include "reference/shape.h"

namespace lodestone {

/// Of a surface: what is met across an edge that is no ridge is met along the normal, or bodies would stumble
/// over the seams of a flat floor.
struct SurfaceTriangle {
  Vec3 normal = Vec3::UnitZ();
  std::array<Vec3, 3> corner;  ///< m, in the part's frame
  std::array<bool, 3>
      ridge{};  ///< whether the edge from corner i to the next stands out, or is the surface's border
  std::array<double, 3> cosine{-1, -1,
                               -1};  ///< from its normal to that of the triangle beyond that edge; −1: none
  std::array<double, 3> thickness{1e300, 1e300, 1e300};  ///< m: below each corner to the other side, where
                                                         ///< the surface has one
  double depth = 0.0;                                    ///< m: so far below its surface it is solid, at most
};

/// All of the solid has normal·x ≤ offset, in its shape's frame.
struct SolidFace {
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward
  double offset = 0.0;          ///< m
};

/// Its axes are those of its part.
struct GroundSolid {
  std::shared_ptr<const Shape> shape;
  Vec3 center = Vec3::Zero();    ///< m, of the shape's frame in the part's
  std::vector<SolidFace> faces;  ///< each normal once
  std::optional<SurfaceTriangle> surface;
};

/// `hull` is about the `center`.
GroundSolid make_ground_solid(Hull hull, const Vec3& center);
/// Of `radius` m, about its part's origin.
GroundSolid make_ground_ball(double radius);

}  // namespace lodestone
