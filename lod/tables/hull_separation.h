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
/// By a face of one of them: `out` of it, and m along that, negative: overlap.
struct FaceSeparation {
  F3 out;
  float gap;
};
/// `line` is from the one to the other; `face` is its own, unturned.
LODESTONE_INLINE FaceSeparation separate_by_face(const float* heights, const Row& face, const MappedHull& one,
                                                 const MappedHull& other, F3 line, float distance) {
  const F3 out = turned(one.turn, {face.x, face.y, face.z});
  return {out, distance * dot(out, line) - face.w -
                   read_map(heights, other.map, place_in_map(turned(back(other.turn), -1.0f * out)))};
}

struct SeparationUpwards {
  F3 normal;  ///< from the second to the first
  float gap;  ///< m along it, negative: overlap
};
/// By the lower one's face that looks up the most, or the upper one's that looks down the most, whichever
/// keeps them farther apart. What passes over the other is apart from it that way, though the line of the
/// centres leaves through a side.
LODESTONE_INLINE SeparationUpwards separate_upwards(const float* heights, const Row* faces,
                                                    const MappedHull& first, const MappedHull& second,
                                                    F3 line, float distance, F3 up) {
  const F3 to_first = choose(dot(line, up) > 0.0f, up, -1.0f * up);  // up or down
  const auto face_of = [&](const MappedHull& one, F3 way) -> const Row& {
    return faces[one.map + place_in_map(turned(back(one.turn), way)).nearest];
  };
  const FaceSeparation by_first = separate_by_face(heights, face_of(first, -1.0f * to_first), first, second,
                                                   -1.0f * line, distance),
                       by_second = separate_by_face(heights, face_of(second, to_first), second, first, line,
                                                    distance);
  const bool of_second = by_second.gap >= by_first.gap;
  return {choose(of_second, by_second.out, -1.0f * by_first.out),
          choose(of_second, by_second.gap, by_first.gap)};
}

/// What says whether one passes over the other.
struct Passing {
  F3 up;       ///< unit; zero without gravity
  F3 way;      ///< m, of the first, seen from the second, in the time that is looked at
  float hair;  ///< m: an overlap that is none
};
/// The best of five separating axes: the line and the normals of the two faces, so that what lies on a face
/// is held by that face; or upwards, where that is better still, or keeps them apart to the end of the way.
/// `unsteady` is that of the kinds (SphereKinds).
LODESTONE_INLINE HullSeparation separate_hulls(const float* heights, const Row* faces, const float* unsteady,
                                               const MappedHull& first, const MappedHull& second, F3 line,
                                               float distance, const LineSeparation& along,
                                               const Passing& passing) {
  const FaceSeparation by_first = separate_by_face(heights, faces[along.first], first, second, -1.0f * line,
                                                   distance),
                       by_second =
                           separate_by_face(heights, faces[along.second], second, first, line, distance);
  const SeparationUpwards upwards =
      separate_upwards(heights, faces, first, second, line, distance, passing.up);
  const F3 of_first = -1.0f * by_first.out;
  const float gap = most(most(by_first.gap, by_second.gap), along.gap);
  const bool of_line = along.gap > most(by_first.gap, by_second.gap);
  const F3 normal = choose(of_line, line, choose(by_first.gap > by_second.gap, of_first, by_second.out));
  const float then = upwards.gap + least(0.0f, dot(passing.way, upwards.normal));
  const bool over =
      (dot(upwards.normal, normal) < kFlushCosine) & ((then > -passing.hair) | (upwards.gap > gap));
  const float cosine = choose(of_line | over, -1.0f, dot(of_first, by_second.out));
  return {choose(over, upwards.normal, normal), choose(over, upwards.gap, gap),
          cosine > kFlushCosine + unsteady[along.first] + unsteady[along.second]};
}

}  // namespace lodestone::lane
