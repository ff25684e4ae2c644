#include "lod/contact/touching_features.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

// Vertices this near the touching plane, over the lesser R, belong to the touching feature. (Over the R of a
// great slab it would have those of its other side, too.)
constexpr double kFeatureMargin = 0.01;

// Cosine between the normals of the touching plane and of a face that is about to lie on it, at least.
constexpr double kLying = 0.9;

/// Points of a body that lie nearest to the touching plane, as arms (m) from an origin that both bodies
/// share: first the nearest of all, then the others in any order.
struct TouchingFeature {
  std::array<Vec3, kMostCorners> corner;
  int count = 0;
  std::span<const Vec3> corners() const { return std::span(corner).first(std::size_t(count)); }
};

// m: how far its other corners are from the nearest one.
double width_of(const TouchingFeature& feature) {
  double width = 0.0;
  for (const Vec3& corner : feature.corners()) width = std::max(width, (corner - feature.corner[0]).norm());
  return width;
}

// The vertices that lie within `hair` m of the touching plane, as arms from `origin`. Returns the nearest of
// all; −1 for a sphere.
std::int32_t find_feature(const PairBody& body, const Vec3& normal, std::int32_t vertex, const Vec3& origin,
                          double hair, TouchingFeature& feature) {
  const Vec3 arm = body.position - origin;
  if (body.shape->sphere_radius) {
    feature.corner[0] = arm - *body.shape->sphere_radius * normal;
    feature.count = 1;
    return -1;
  }
  const Hull& hull = body.shape->hull;
  const Vec3 own = body.orientation.conjugate() * normal;
  vertex = find_support(hull, -own, std::max(vertex, 0));
  std::array<std::int32_t, kMostCorners> vertices;
  feature.count = find_vertices_below(*body.shape, own, 0.0,
                                      own.dot(hull.vertices[std::size_t(vertex)]) + hair, vertex, vertices);
  const Mat3 turn = body.orientation.toRotationMatrix();
  for (int i = 0; i < feature.count; ++i)
    feature.corner[std::size_t(i)] = arm + turn * hull.vertices[std::size_t(vertices[std::size_t(i)])];
  return vertex;
}

// The face around a vertex that lies most nearly in the touching plane, its normal outward, in the body's
// axes.
Vec3 find_flattest_face(const Hull& hull, std::int32_t vertex, const Vec3& down) {
  Vec3 flattest = Vec3::Zero();
  for (const std::int32_t face : hull.faces_of(vertex))
    if (const Vec3 outward = hull.face_normals[std::size_t(face)]; outward.dot(down) > flattest.dot(down))
      flattest = outward;
  return flattest;
}

// Where a body comes down on an edge or a corner of a wide face that is about to lie, makes its feature the
// whole face: the impulse at the edge turns the face's other corners down within the same step, the faster
// the thinner the body is. Without this, plates that land strike with alternate edges, each time deeper.
// `ahead`, m: how much farther than the nearest vertex those corners may be.
void extend_to_face(const PairBody& body, const Vec3& normal, std::int32_t vertex, const Vec3& origin,
                    double hair, double ahead, TouchingFeature& feature) {
  if (vertex < 0 || feature.count > 2) return;
  const Vec3 down = body.orientation.conjugate() * -normal,
             flattest = find_flattest_face(body.shape->hull, vertex, down);
  if (flattest.dot(down) < kLying) return;
  TouchingFeature face;
  find_feature(body, body.orientation * -flattest, vertex, origin, hair, face);
  double farthest = 0.0;
  for (const Vec3& corner : face.corners())
    farthest = std::max(farthest, (corner - feature.corner[0]).dot(normal));
  if (face.count > 2 && width_of(face) >= body.shape->radius && farthest <= ahead) feature = face;
}

// Of a round body, vertices on several faces are that near, and the outermost of them would hide the nearest,
// over which it rolls. Keeps only those on the face that is most nearly in the touching plane.
void keep_one_face(const PairBody& body, const Vec3& normal, std::int32_t vertex, double hair,
                   TouchingFeature& feature) {
  constexpr double kFlat = 0.1;  // over the hair: how far a face's corners may be off its plane
  if (feature.count < 3) return;
  const Vec3 down = body.orientation.conjugate() * -normal,
             outward = body.orientation * find_flattest_face(body.shape->hull, vertex, down);
  const double offset = outward.dot(feature.corner[0]) - kFlat * hair;
  int kept = 0;
  for (int i = 0; i < feature.count; ++i)
    if (const Vec3 corner = feature.corner[std::size_t(i)]; outward.dot(corner) >= offset)
      feature.corner[std::size_t(kept++)] = corner;
  feature.count = kept;
}

Manifold clip_features(const PairBody& first, const PairBody& second, const HullGap& best, const Ahead& ahead,
                       TouchingFeature& upper, TouchingFeature& lower) {
  const double hair = kFeatureMargin * std::min(first.shape->radius, second.shape->radius);
  const auto find = [&](const PairBody& body, const Vec3& normal, std::int32_t near, double within,
                        TouchingFeature& feature) {
    const std::int32_t nearest = find_feature(body, normal, near, second.position, within, feature);
    keep_one_face(body, normal, nearest, hair, feature);
  };
  find(first, best.normal, best.vertex_first, hair + ahead.first, upper);
  find(second, -best.normal, best.vertex_second, hair, lower);
  if (ahead.lying > 0.0) {
    extend_to_face(first, best.normal, best.vertex_first, second.position, hair, ahead.lying, upper);
    extend_to_face(second, -best.normal, best.vertex_second, second.position, hair, ahead.lying, lower);
  }
  return find_manifold(upper.corners(), lower.corners(), best.normal, best.gap);
}

}  // namespace

Manifold clip_features(const PairBody& first, const PairBody& second, const HullGap& best,
                       const Ahead& ahead) {
  TouchingFeature upper, lower;
  return clip_features(first, second, best, ahead, upper, lower);
}

Manifold find_shared_points(const PairBody& first, const PairBody& second, const HullGap& best,
                            const Ahead& ahead) {
  TouchingFeature upper, lower;
  Manifold manifold = clip_features(first, second, best, ahead, upper, lower);
  if (manifold.count == 0) {  // the axis is not quite that of the nearest features
    // The nearest corner of the smaller one: a point between both may be off it.
    const bool upper_is_smaller = width_of(upper) <= width_of(lower);
    manifold.points[0] = {upper_is_smaller ? Vec3(upper.corner[0] - 0.5 * best.gap * best.normal)
                                           : Vec3(lower.corner[0] + 0.5 * best.gap * best.normal),
                          best.gap};
    manifold.count = 1;
  }
  for (ManifoldPoint& p : manifold.points) p.point += second.position;
  return manifold;
}

}  // namespace lodestone
