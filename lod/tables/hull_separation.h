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
/// m along the normal of the lower one's face that looks up the most, negative: overlap. What passes over it
/// is apart from it that way, though the line of the centres leaves through a side.
struct SeparationUpwards {
  F3 normal;  ///< from the second to the first
  float gap;
};
LODESTONE_INLINE SeparationUpwards separate_upwards(const float* heights, const Row* faces,
                                                    const MappedHull& first, const MappedHull& second,
                                                    F3 line, float distance, F3 up) {
  const bool on_second = dot(line, up) > 0.0f;
  const auto pick = [&](const MappedHull& a, const MappedHull& b) {
    return MappedHull{choose(on_second, a.map, b.map),
                      {choose(on_second, a.turn.w, b.turn.w), choose(on_second, a.turn.v, b.turn.v)}};
  };
  const MappedHull lower = pick(second, first), upper = pick(first, second);
  const Row& face = faces[lower.map + place_in_map(turned(back(lower.turn), up)).nearest];
  const F3 out = turned(lower.turn, {face.x, face.y, face.z}), normal = choose(on_second, 1.0f, -1.0f) * out;
  return {normal, distance * dot(normal, line) - face.w -
                      read_map(heights, upper.map, place_in_map(turned(back(upper.turn), -1.0f * out)))};
}

/// What says whether one passes over the other.
struct Passing {
  F3 up;       ///< unit; zero without gravity
  F3 way;      ///< m, of the first, seen from the second, in the time that is looked at
  float hair;  ///< m: an overlap that is none
};
/// The best of four separating axes: the line and the normals of the two faces, so that what lies on a face
/// is held by that face; or upwards, where that is better still, or keeps them apart to the end of the way.
/// `unsteady` is that of the kinds (SphereKinds).
LODESTONE_INLINE HullSeparation separate_hulls(const float* heights, const Row* faces, const float* unsteady,
                                               const MappedHull& first, const MappedHull& second, F3 line,
                                               float distance, const LineSeparation& along,
                                               const Passing& passing) {
  const Row &by_first = faces[along.first], &by_second = faces[along.second];
  const F3 of_first = -1.0f * turned(first.turn, {by_first.x, by_first.y, by_first.z}),
           of_second = turned(second.turn, {by_second.x, by_second.y, by_second.z});
  const float gap_first = distance * dot(of_first, line) - by_first.w -
                          read_map(heights, second.map, place_in_map(turned(back(second.turn), of_first))),
              gap_second =
                  distance * dot(of_second, line) - by_second.w -
                  read_map(heights, first.map, place_in_map(turned(back(first.turn), -1.0f * of_second)));
  const SeparationUpwards upwards =
      separate_upwards(heights, faces, first, second, line, distance, passing.up);
  const float gap = most(most(gap_first, gap_second), along.gap);
  const bool of_line = along.gap > most(gap_first, gap_second);
  const F3 normal = choose(of_line, line, choose(gap_first > gap_second, of_first, of_second));
  const float then = upwards.gap + least(0.0f, dot(passing.way, upwards.normal));
  const bool over =
      (dot(upwards.normal, normal) < kFlushCosine) & ((then > -passing.hair) | (upwards.gap > gap));
  const float cosine = choose(of_line | over, -1.0f, dot(of_first, of_second));
  return {choose(over, upwards.normal, normal), choose(over, upwards.gap, gap),
          cosine > kFlushCosine + unsteady[along.first] + unsteady[along.second]};
}

}  // namespace lodestone::lane
