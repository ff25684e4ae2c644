#include "lod/contact/passed_faces.h"

#include <algorithm>

#include "lod/contact/touching_features.h"

namespace lodestone {
namespace {

// The normal (from the second into the first) of the face of either hull that the other one lies over by
// most, now and at the end of its way; none of hulls of many faces.
std::optional<Vec3> find_passed_normal(const PairBody& first, const PairBody& second,
                                       const PairContact& contact, const PairWay& way) {
  constexpr std::size_t kMostFaces = 64;  // triangles
  const PlacedHull a = placed_hull(first), b = placed_hull(second);
  const ManifoldPoint& p = contact.manifold.points[0];
  const Vec3 apart = first.position - second.position;
  std::optional<Vec3> passed;
  double most = -way.hair;  // m
  // Looks at a `face` of `one`; a point of the other is at `point`, from the centre of `one`. `sign`: 1 where
  // `one` is the second, else −1.
  const auto look_at = [&](const PlacedHull& one, std::size_t face, const Vec3& point, double sign) {
    const Hull& hull = one.shape->hull;
    const Vec3 outward = one.rotation * hull.face_normals[face], normal = sign * outward;
    const double turning = normal.cross(way.first_turn).norm() * first.shape->radius +
                           normal.cross(way.second_turn).norm() * second.shape->radius,
                 least_change = std::min(0.0, way.first.dot(normal) - turning),
                 plane = hull.face_normals[face].dot(hull.vertices[std::size_t(hull.faces[face][0])]);
    if (outward.dot(point) - plane + least_change < most || normal.dot(apart) <= 0.0) return;
    if (passed && passed->dot(normal) > 0.9999) return;
    const double gap = measure_hull_gap(a, b, normal).gap;
    if (gap + least_change >= most) most = gap + least_change, passed = normal;
  };
  const auto look_at_all = [&](const PlacedHull& one, const Vec3& point, double sign) {
    const std::size_t count = one.shape->hull.face_normals.size();
    if (one.shape->sphere_radius || count > kMostFaces) return;
    for (std::size_t face = 0; face < count; ++face) look_at(one, face, point, sign);
  };
  look_at_all(b, p.point + 0.5 * p.gap * contact.normal - second.position, 1.0);
  look_at_all(a, p.point - 0.5 * p.gap * contact.normal - first.position, -1.0);
  return passed;
}

}  // namespace

std::optional<PairContact> pass_over(const PairBody& first, const PairBody& second, const PairWay& way,
                                     const PairContact& contact, HullGap& axis) {
  constexpr double kSameWay = 0.99;  // cosine
  const auto passed = find_passed_normal(first, second, contact, way);
  if (!passed || contact.normal.dot(*passed) > kSameWay) return contact;
  const HullGap along = measure_hull_gap(placed_hull(first), placed_hull(second), *passed);
  PairContact with_face{*passed, along.gap, clip_features(first, second, along, {})};
  for (ManifoldPoint& p : with_face.manifold.points) p.point += second.position;  // they were from its centre
  const bool is_over = with_face.manifold.count > 0 && along.gap <= way.hair;
  if (!is_over && contact.gap < 0.0) return contact;
  axis = along;
  return is_over ? std::optional(with_face) : std::nullopt;
}

}  // namespace lodestone
