// Which way two hulls are apart, and how far, by the maps of their heights and faces: for loops over pairs.
#pragma once

#include "lod/tables/hull_heights.h"

namespace lodestone::lane {

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

/// Of the angle between two faces that lie on each other, or one on a plane, at most: 3.6°.
inline constexpr float kFlushCosine = 0.998f;

struct HullSeparation {
  F3 normal;   ///< from the second to the first
  float gap;   ///< m, negative: overlap; no more than the hulls' distance
  bool flush;  ///< face lies on face, the line of the centres goes through both, and on these both stand
               ///< firmly
};
/// The best of three separating axes, the line and the normals of the two faces, so that what lies on a face
/// is held by that face. `unsteady` is that of the kinds (SphereKinds).
LODESTONE_INLINE HullSeparation separate_hulls(const float* heights, const Row* faces, const float* unsteady,
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
  const bool of_line = along.gap > gap;
  const float cosine = choose(of_line, -1.0f, dot(of_first, of_second));
  return {choose(of_line, line, choose(gap_first > gap_second, of_first, of_second)), most(along.gap, gap),
          cosine > kFlushCosine + unsteady[along.first] + unsteady[along.second]};
}

}  // namespace lodestone::lane
