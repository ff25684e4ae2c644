// How far apart two convex hulls are, and along which axis (Gilbert, Johnson and Keerthi, A fast procedure
// for computing the distance between complex objects in three-dimensional space, 1988). Hulls that overlap
// are first taken apart along an axis that served before.
#pragma once

#include <algorithm>
#include <array>

#include "reference/shape.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A hull where it stands, as a search sees it.
struct PlacedHull {
  const Shape* shape = nullptr;
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Mat3 rotation = Mat3::Identity();  ///< of `orientation`

  PlacedHull(const Shape& placed, const Vec3& at, const Quat& turned)
      : shape(&placed), position(at), orientation(turned), rotation(turned.toRotationMatrix()) {}
  /// From the centre of mass to the point farthest along `direction` (unit). The climb starts at `vertex` and
  /// leaves what it found there; −1: none known.
  Vec3 find_farthest(const Vec3& direction, std::int32_t& vertex) const;
  /// m, from the centre of mass.
  Vec3 arm_of(std::int32_t vertex) const {
    return shape->sphere_radius ? Vec3(Vec3::Zero())
                                : Vec3(rotation * shape->hull.vertices[std::size_t(vertex)]);
  }
};

/// A corner of the difference of two hulls: a vertex of each. Those between which the nearest point of the
/// difference lies tell where the next search begins.
struct HullCorner {
  std::int32_t first = -1, second = -1;
};

struct HullGap {
  Vec3 normal = Vec3::UnitZ();  ///< from the second to the first
  double gap = -1e300;  ///< m, of the hulls along it: their distance where they are apart; negative: how deep
  std::int32_t vertex_first = -1, vertex_second = -1;  ///< that bound it
  std::array<HullCorner, 3> corners{};                 ///< of the last search
  std::int32_t corner_count = 0;

  void archive(StateArchive& a) { a(normal, gap, vertex_first, vertex_second, corners, corner_count); }
};

/// m: a gap that is as good as any wider one, since two bodies cannot close it.
struct Enough {
  double still = 0.0;       ///< whichever way they go
  Vec3 way = Vec3::Zero();  ///< and how the first one goes, seen from the second

  Enough(double everywhere) : still(everywhere) {}
  Enough(double everywhere, const Vec3& goes) : still(everywhere), way(goes) {}
  double along(const Vec3& normal) const { return still + std::max(0.0, -way.dot(normal)); }
  double anywhere() const { return still + way.norm(); }
};

/// The axis of the greatest gap, from `start` (its normal, zero: the line of centres; its vertices, −1:
/// unknown). Ends early, with a gap above `enough`, once an axis shows one. Not `exact`: of hulls that
/// overlap deeply any axis that was found will do, since the one of least depth takes a long search.
HullGap find_hull_gap(const PlacedHull& first, const PlacedHull& second, const HullGap& start,
                      const Enough& enough, bool exact = true);

/// Whether they do not overlap; `gap` is where the search begins and what it finds: their distance, or a gap
/// above `enough`.
bool are_apart(const PlacedHull& first, const PlacedHull& second, const Enough& enough, HullGap& gap);

/// The gap along one axis (unit).
HullGap measure_hull_gap(const PlacedHull& first, const PlacedHull& second, const Vec3& normal,
                         const HullGap& hints = {});

}  // namespace lodestone
