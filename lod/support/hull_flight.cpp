#include "lod/support/hull_flight.h"

#include <cmath>

namespace lodestone {
namespace {

constexpr int kMostSteps = 12;

// s until h + v t + a t²/2 = 0 for a gap h that closes (v < 0), the root next to t = 0; negative inside.
double time_to_close(double gap, const GapMotion& motion) {
  const double square = motion.velocity * motion.velocity - 2.0 * motion.acceleration * gap;
  return 2.0 * gap / (-motion.velocity + std::sqrt(std::max(0.0, square)));
}

}  // namespace

LowestPoint HullFlight::find_lowest(const HullPose& pose, std::int32_t& hint) const {
  const Shape& shape = *kind_.shape;
  LowestPoint lowest;
  for (int i = 0; i < int(world_.planes.size()); ++i) {
    const HalfSpace& plane = world_.planes[std::size_t(i)];
    const double height = plane.height_of(pose.position);
    if (height > shape.radius || height - shape.radius > lowest.gap) continue;
    const Vec3 normal = pose.orientation.conjugate() * plane.normal;
    Vec3 arm;
    if (shape.sphere_radius) {
      arm = -*shape.sphere_radius * normal;
    } else {
      hint = find_support(shape.hull, -normal, hint);
      arm = shape.hull.vertices[std::size_t(hint)];
    }
    const double gap = height + arm.dot(normal);
    if (gap < lowest.gap) lowest = {i, gap, normal, arm};
  }
  return lowest;
}

// In body axes r̈ = ω̇ × r + ω × (ω × r), with I ω̇ = L × ω (Euler's equations).
GapMotion HullFlight::gap_motion(const HullPose& pose, const LowestPoint& lowest, double time) const {
  const Vec3& normal = world_.planes[std::size_t(lowest.plane)].normal;
  GapMotion motion{velocity_at(time).dot(normal), world_.gravity.dot(normal)};
  if (kind_.shape->sphere_radius) return motion;
  const Mat3& inverse = kind_.shape->inverse_inertia_per_mass;
  const Vec3 spin = pose.orientation.conjugate() * body_.spin, omega = inverse * spin,
             turning = omega.cross(lowest.arm);
  motion.velocity += turning.dot(lowest.normal);
  motion.acceleration +=
      ((inverse * spin.cross(omega)).cross(lowest.arm) + omega.cross(turning)).dot(lowest.normal);
  return motion;
}

Impact HullFlight::find_impact(const Impact& end, double tolerance, std::int32_t& hint) const {
  Impact now = end;
  double before = 0.0, after = end.time;
  bool start_is_known = false;
  for (int i = 0; i < kMostSteps && std::abs(now.lowest.gap) > tolerance; ++i) {
    const GapMotion motion = now.lowest.plane < 0 ? GapMotion() : gap_motion(now.pose, now.lowest, now.time);
    double next = before;
    if (motion.velocity < 0.0) next = now.time + time_to_close(now.lowest.gap, motion);
    if (next <= 0.0 && before == 0.0 && !start_is_known && motion.velocity < 0.0) {
      next = 0.0;
      start_is_known = true;
    } else if (!(next > before && next < after)) {
      next = 0.5 * (before + after);
    }
    now.time = next;
    now.pose = pose_at(next);
    now.lowest = find_lowest(now.pose, hint);
    if (now.lowest.gap < 0.0)
      after = next;
    else
      before = next;
    if (after <= 0.0) break;
  }
  return now;
}

}  // namespace lodestone
