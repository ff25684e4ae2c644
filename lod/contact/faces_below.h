// Where static boxes and meshes are no more than planes to a body above them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lod/ground/ground.h"

namespace lodestone {

/// A point of the world in the frame of the solid's part.
Vec3 in_part(const PlacedSolid& placed, const Vec3& point);

/// Whether a point, in the part's frame, lies over the triangle or below it, along its normal, or up to
/// `rounding` m beside that.
bool is_over(const SurfaceTriangle& t, const Vec3& point, double rounding = 0.0);
/// Whether a point, in the part's frame, is beyond the other side of what is solid below the triangle: on the
/// far side of a wall.
bool is_behind(const SurfaceTriangle& t, const Vec3& point);
/// m: to it from the nearest point of the edge from corner `edge` to the next.
Vec3 find_way_from_edge(const SurfaceTriangle& t, std::size_t edge, const Vec3& point);

/// The face of `solid` that a ball about `center` lies over wholly, with the solid's other faces farther than
/// `reach` beyond: there it is a plane like any other. None near an edge.
std::optional<HalfSpace> find_face_below(const PlacedSolid& solid, const Vec3& center, double reach);

/// Of a solid that is one triangle of a surface.
struct SurfaceBelow {
  bool in_reach = false;  ///< of a ball
  /// Where the surface goes on beyond it, level or rising, as far as the ball reaches: no edge that stands
  /// out, and no border.
  std::optional<HalfSpace> plane;
};
SurfaceBelow find_surface_below(const PlacedSolid& triangle, const Vec3& center, double reach);

/// Appends the planes of what is within `reach` of a ball of `radius` about `center`, if these are all that
/// it can meet there and no more than a few of a surface. False, and none: there are edges.
bool find_faces_below(std::span<const PlacedSolid> near, const Vec3& center, double radius, double reach,
                      std::vector<HalfSpace>& planes);

/// Whether all of it is triangles of surfaces without an edge within `reach` that stands out, or is a border.
bool is_smooth(std::span<const PlacedSolid> near, const Vec3& center, double reach);

/// One plane for gentle ground of triangles below `center`: the mean of those in reach, the nearer the more,
/// so that it turns by degrees as a body moves on. None beyond a border, over several layers, or where a
/// triangle's normal and the plane's have a cosine below `least_cosine`.
std::optional<HalfSpace> find_mean_plane(std::span<const PlacedSolid> near, const Vec3& center, double reach,
                                         double least_cosine);

}  // namespace lodestone
