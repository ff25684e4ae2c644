#include "lod/contact/triangle_sieve.h"

#include <algorithm>

#include "lod/contact/faces_below.h"

namespace lodestone {

TriangleSieve::TriangleSieve(const PairBody& body, const SieveMotion& motion) : body_(body), motion_(motion) {
  const VertexLanes& lanes = body.shape->hull.lanes;
  const auto measure = [&](const std::vector<float>& along, int axis) {
    const auto [least, greatest] = std::ranges::minmax(along);
    middle_of_box_[axis] = 0.5 * (double(least) + double(greatest));
    half_[axis] = 0.5 * (double(greatest) - double(least));
  };
  measure(lanes.x, 0), measure(lanes.y, 1), measure(lanes.z, 2);
  half_.array() += 1e-6 * body.shape->radius;  // more than what floats and searches err by
}

void TriangleSieve::see_from(const PlacedSolid& triangle) {
  part_ = triangle.part;
  axes_ = (triangle.orientation.conjugate() * body_.orientation).toRotationMatrix();
  sides_ = axes_ * half_.asDiagonal();
  arm_ = axes_ * middle_of_box_;
  middle_ = in_part(triangle, body_.position) + arm_;
  velocity_ = triangle.orientation.conjugate() * motion_.velocity;
  omega_ = triangle.orientation.conjugate() * motion_.omega;
}

// m/s, of the box's points and of those half a margin beside it.
double TriangleSieve::least_velocity_along(const Vec3& normal) const {
  const Vec3 by_arm = normal.cross(omega_);
  return normal.dot(velocity_) + by_arm.dot(arm_) - extent_along(by_arm) -
         0.5 * motion_.margin * by_arm.norm();
}

bool TriangleSieve::is_beyond(const PlacedSolid& triangle) {
  if (triangle.part != part_) see_from(triangle);
  const SurfaceTriangle& t = *triangle.solid->surface;
  const Vec3 from[3] = {t.corner[0] - middle_, t.corner[1] - middle_, t.corner[2] - middle_};
  const double height = -t.normal.dot(from[0]) - extent_along(t.normal);
  if (height > motion_.margin) return true;
  if (height > motion_.touching && !part_->moves() &&
      height + least_velocity_along(t.normal) * motion_.time > motion_.touching)
    return true;
  const double margin = motion_.margin + std::max(0.0, motion_.deepest - t.depth);
  const Vec3 a = axes_.transpose() * from[0], b = axes_.transpose() * from[1],
             c = axes_.transpose() * from[2], down = -t.depth * (axes_.transpose() * t.normal);
  const Vec3 least = a.cwiseMin(b).cwiseMin(c) + down.cwiseMin(0.0),
             greatest = a.cwiseMax(b).cwiseMax(c) + down.cwiseMax(0.0);
  if ((least.array() > half_.array() + margin).any() || (greatest.array() < -half_.array() - margin).any())
    return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t.corner[(i + 1) % 3] - t.corner[i], outward = edge.cross(t.normal);
    if (-outward.dot(from[i]) - extent_along(outward) > margin * edge.norm()) return true;
  }
  return false;
}

}  // namespace lodestone
