#include "lod/contact/passed_faces.h"

#include <algorithm>
#include <cstdint>

#include "lod/contact/touching_features.h"

namespace lodestone {
namespace {

/// A hull of few faces, over whose faces another one may lie.
struct PassedHull {
  const PlacedHull &own, &other;
  double sign;                // of its faces' normals, from the second hull into the first
  std::int32_t other_vertex;  // of the other one: where the search for its lowest one begins
};

// The normal (from the second into the first) of the face of either hull that the other one lies over by
// most, now and at the end of its way; none of hulls of many faces. `axis`: that of the contact.
std::optional<Vec3> find_passed_normal(const PairBody& first, const PairBody& second,
                                       const PairContact& contact, const PairWay& way, const HullGap& axis) {
  constexpr std::size_t kMostFaces = 64;  // triangles
  constexpr double kOneFace = 0.9999;     // cosine of their normals: triangles of one face
  const PlacedHull a = placed_hull(first), b = placed_hull(second);
  const ManifoldPoint& p = contact.manifold.points[0];
  const Vec3 apart = first.position - second.position;
  std::optional<Vec3> passed;
  double most = -way.hair;  // m
  // `height`: of a point of the other hull over the face, m.
  const auto look_at = [&](const PassedHull& hull, std::size_t face, double height) {
    const Shape& shape = *hull.own.shape;
    const Vec3 outward = hull.own.rotation * shape.hull.face_normals[face], normal = hull.sign * outward;
    if (normal.dot(apart) <= 0.0 || (passed && passed->dot(normal) > kOneFace)) return;
    const double turning = normal.cross(way.first_turn).norm() * first.shape->radius +
                           normal.cross(way.second_turn).norm() * second.shape->radius,
                 least_change = std::min(0.0, way.first.dot(normal) - turning);
    if (height + least_change < most) return;
    std::int32_t vertex = hull.other_vertex;
    const Vec3 lowest = hull.other.position - hull.own.position + hull.other.find_farthest(-outward, vertex);
    const double gap = outward.dot(lowest) - shape.hull.face_normals[face].dot(
                                                 shape.hull.vertices[std::size_t(shape.hull.faces[face][0])]);
    if (gap + least_change >= most) most = gap + least_change, passed = normal;
  };
  // `point`, of the other hull, is where it is nearest.
  const auto look_at_all = [&](const PassedHull& hull, const Vec3& point) {
    const Shape& shape = *hull.own.shape;
    const std::size_t count = shape.hull.face_normals.size();
    if (shape.sphere_radius || count > kMostFaces) return;
    const Vec3 own = hull.own.rotation.transpose() * (point - hull.own.position);
    for (std::size_t face = 0; face < count; ++face) {
      const Vec3& corner = shape.hull.vertices[std::size_t(shape.hull.faces[face][0])];
      const double height = shape.hull.face_normals[face].dot(own - corner);
      if (height >= most) look_at(hull, face, height);
    }
  };
  const Vec3 half = 0.5 * p.gap * contact.normal;
  look_at_all({b, a, 1.0, axis.vertex_first}, p.point + half);
  look_at_all({a, b, -1.0, axis.vertex_second}, p.point - half);
  return passed;
}

}  // namespace

std::optional<PairContact> pass_over(const PairBody& first, const PairBody& second, const PairWay& way,
                                     const PairContact& contact, HullGap& axis) {
  constexpr double kSameWay = 0.99;  // cosine
  const auto passed = find_passed_normal(first, second, contact, way, axis);
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
