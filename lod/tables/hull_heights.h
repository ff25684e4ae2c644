// A hull seen from its centre of mass: how far it reaches in a direction, which is its support function, and
// the face there, sampled over an octahedral map (Cigolle et al., A survey of efficient representations for
// independent unit vectors, 2014), which needs no trigonometry to read.
#pragma once

#include <algorithm>
#include <span>

#include "lod/simd/lane_math.h"
#include "lod/simd/row.h"
#include "reference/hull/resting_faces.h"
#include "reference/shape.h"

namespace lodestone {

inline constexpr int kHullHeightSide = 24;  // cells along an edge of the map: 5° apart on average
inline constexpr int kHullHeights = (kHullHeightSide + 1) * (kHullHeightSide + 1);

/// The points of a hull that are farthest within kPatchAngle of a direction: a corner, an edge or a face.
struct SupportPatch {
  lane::F3 mean{};                                                         ///< m, body axes
  float xx = 0.0f, yy = 0.0f, zz = 0.0f, xy = 0.0f, xz = 0.0f, yz = 0.0f;  ///< m²: how they spread about it
  /// Along one direction and another.
  LODESTONE_INLINE float spread(lane::F3 a, lane::F3 b) const {
    return a.x * (xx * b.x + xy * b.y + xz * b.z) + a.y * (xy * b.x + yy * b.y + yz * b.z) +
           a.z * (xz * b.x + yz * b.y + zz * b.z);
  }
};
inline constexpr float kPatchAngle = 0.13f;  // rad: of what may be told apart in the maps, the least

/// Of kHullHeights directions, body axes. What others meet is smaller, by the same factor all over, where the
/// mesh does not fill its hull.
struct HullMaps {
  std::span<float> height;       ///< m: how far the hull reaches, as the ground meets it
  std::span<float> pair_height;  ///< m, as others meet it
  std::span<SupportPatch> patch;
  std::span<lane::Row> pair_face;  ///< the face through which the direction leaves it: its normal, and in w
                                   ///< its distance, m
};
void sample_hull(const Shape& shape, const HullMaps& maps);

/// Of each of `faces`, as sample_hull finds them: 0 where the body stands on it firmly, however it is pulled
/// along within 17° of its normal, 1 elsewhere and where nobody knows (null).
void find_unsteady(const RestingFaces* stands, std::span<const lane::Row> faces, std::span<float> unsteady);

/// Of the mean lever, for spheres among their like: with it piles come to rest when ODE's do.
inline constexpr double kRollingShare = 0.2;

/// m², body axes: of the rolling resistance of hulls among others, whose lever about an axis u has the square
/// uᵀ L u. A sphere rolls on where a hull lies on a face or falls from edge to edge, and each of these holds
/// it by its weight times what its lowest point lies beside the centre of mass: a log about its own axis
/// hardly at all. In the mean kRollingShare of that over all directions; 0 of a ball.
Mat3 find_rolling_levers(const Shape& shape);

namespace lane {

/// Where a direction (of any length but 0) lies in a map: the first of four samples about it, how far it is
/// from that towards the next ones, and the nearest of them.
struct MapPlace {
  int first, nearest;
  float s, t;
};
LODESTONE_INLINE MapPlace place_in_map(F3 direction) {
  const float whole = absolute(direction.x) + absolute(direction.y) + absolute(direction.z),
              scale = 1.0f / most(whole, 1e-30f);
  const float x = direction.x * scale, y = direction.y * scale;
  // The lower half is folded out over the map's corners.
  const float over_x = choose(x < 0.0f, absolute(y) - 1.0f, 1.0f - absolute(y)),
              over_y = choose(y < 0.0f, absolute(x) - 1.0f, 1.0f - absolute(x));
  constexpr float kHalf = 0.5f * float(kHullHeightSide), kLast = float(kHullHeightSide) - 0.01f;
  const bool below = direction.z < 0.0f;
  const float u = (choose(below, over_x, x) + 1.0f) * kHalf, v = (choose(below, over_y, y) + 1.0f) * kHalf;
  const int column = int(least(u, kLast)), row = int(least(v, kLast));
  const float s = u - float(column), t = v - float(row);
  const int first = row * (kHullHeightSide + 1) + column;
  const int next_column = choose(s < 0.5f, 0, 1), next_row = choose(t < 0.5f, 0, kHullHeightSide + 1);
  return {first, first + next_column + next_row, s, t};
}

/// Linear between the four samples of the map that begins at `heights[map]`.
LODESTONE_INLINE float read_map(const float* heights, int map, const MapPlace& place) {
  const int at = map + place.first, next = at + kHullHeightSide + 1;
  const float low = heights[at] + place.s * (heights[at + 1] - heights[at]),
              high = heights[next] + place.s * (heights[next + 1] - heights[next]);
  return low + place.t * (high - low);
}

}  // namespace lane

/// m, along `direction` (body axes, of any length but 0), of the map that begins at `heights[first]`.
LODESTONE_INLINE float read_hull_height(const float* heights, int first, lane::F3 direction) {
  return lane::read_map(heights, first, lane::place_in_map(direction));
}

/// Linear between the four samples about a place.
inline SupportPatch read_patch(const SupportPatch* patches, const lane::MapPlace& place) {
  const auto between = [](const SupportPatch& a, const SupportPatch& b, float t) {
    const auto mix = [t](float from, float to) { return from + t * (to - from); };
    return SupportPatch{a.mean + t * (b.mean - a.mean),
                        mix(a.xx, b.xx),
                        mix(a.yy, b.yy),
                        mix(a.zz, b.zz),
                        mix(a.xy, b.xy),
                        mix(a.xz, b.xz),
                        mix(a.yz, b.yz)};
  };
  const SupportPatch *low = patches + place.first, *high = low + kHullHeightSide + 1;
  return between(between(low[0], low[1], place.s), between(high[0], high[1], place.s), place.t);
}

/// m: no lower over what bears it is the centre of a body whose hull is above that; and none is taken for so.
inline double least_height(const Shape& shape) {
  constexpr double kLeast = 0.02;  // over R
  return std::min(kLeast * shape.radius, shape.inner_radius);
}

}  // namespace lodestone
