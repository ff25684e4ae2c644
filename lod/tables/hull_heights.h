// How far a hull reaches from its centre of mass in a direction: its support function, sampled over an
// octahedral map (Cigolle et al., A survey of efficient representations for independent unit vectors, 2014),
// which needs no trigonometry to read.
#pragma once

#include <span>

#include "lod/simd/lane_math.h"
#include "lod/simd/row.h"
#include "reference/shape.h"

namespace lodestone {

inline constexpr int kHullHeightSide = 24;  // cells along an edge of the map: 5° apart on average
inline constexpr int kHullHeights = (kHullHeightSide + 1) * (kHullHeightSide + 1);

/// Of kHullHeights directions, body axes. What others meet is smaller, by the same factor all over, where the
/// mesh does not fill its hull.
struct HullMaps {
  std::span<float> height;         ///< m: how far the hull reaches, as the ground meets it
  std::span<float> pair_height;    ///< m, as others meet it
  std::span<lane::Row> pair_face;  ///< the face through which the direction leaves it: its normal, and in w
                                   ///< its distance, m
};
void sample_hull(const Shape& shape, const HullMaps& maps);

/// m, of the rolling resistance of hulls among others: a sphere rolls on where a hull lies on a face or falls
/// from edge to edge, and each of these holds it by its weight times what its lowest point lies beside the
/// centre of mass. Part of the mean of that over all directions; 0 of a ball.
double find_rolling_lever(const Shape& shape);

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

/// Where the maps of its kind begin, and how it is turned.
struct MappedHull {
  int map;
  Turn turn;
};
/// Of two hulls whose centres of mass are apart along a line.
struct LineSeparation {
  float gap;          ///< m along it, negative: overlap; no more than the hulls' distance
  int first, second;  ///< where the maps of faces hold those through which it leaves the two
};
/// `line` is from the second to the first, of length 1; m.
LODESTONE_INLINE LineSeparation separate_along_line(const float* heights, const MappedHull& first,
                                                    const MappedHull& second, F3 line, float distance) {
  const MapPlace from_first = place_in_map(turned(back(first.turn), -1.0f * line)),
                 from_second = place_in_map(turned(back(second.turn), line));
  return {distance - read_map(heights, first.map, from_first) - read_map(heights, second.map, from_second),
          first.map + from_first.nearest, second.map + from_second.nearest};
}

struct HullSeparation {
  F3 normal;  ///< from the second to the first
  float gap;  ///< m, negative: overlap; no more than the hulls' distance
};
/// The best of three separating axes, the line and the normals of the two faces, so that what lies on a face
/// is held by that face.
LODESTONE_INLINE HullSeparation separate_hulls(const float* heights, const Row* faces,
                                               const MappedHull& first, const MappedHull& second, F3 line,
                                               float distance, const LineSeparation& along) {
  const Row &by_first = faces[along.first], &by_second = faces[along.second];
  const F3 of_first = -1.0f * turned(first.turn, {by_first.x, by_first.y, by_first.z}),
           of_second = turned(second.turn, {by_second.x, by_second.y, by_second.z});
  const float gap_first = distance * dot(of_first, line) - by_first.w -
                          read_map(heights, second.map, place_in_map(turned(back(second.turn), of_first))),
              gap_second =
                  distance * dot(of_second, line) - by_second.w -
                  read_map(heights, first.map, place_in_map(turned(back(first.turn), -1.0f * of_second)));
  const float gap = most(gap_first, gap_second);
  return {choose(along.gap > gap, line, choose(gap_first > gap_second, of_first, of_second)),
          most(along.gap, gap)};
}

}  // namespace lane

/// m, along `direction` (body axes, of any length but 0), of the map that begins at `heights[first]`.
LODESTONE_INLINE float read_hull_height(const float* heights, int first, lane::F3 direction) {
  return lane::read_map(heights, first, lane::place_in_map(direction));
}

}  // namespace lodestone
