#include "lod/contact/pair_coherence.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

// m: by how much no gap has shrunk more since then by how both have turned.
double find_turning_since(const PairPose& then, const PairBody& first, const PairBody& second) {
  // Of two quaternions that are a chord c apart the angle is 4 asin(c / 2), up to half a turn at most 2 c +
  // c³/8.
  const auto turned = [](const PairPose::Turn& from, const Quat& to) {
    const Eigen::Vector4d was = from.cast<double>();
    const double square = std::min((was - to.coeffs()).squaredNorm(), (was + to.coeffs()).squaredNorm());
    return std::sqrt(square) * (2.0 + square / 8.0);
  };
  return turned(then.first, first.orientation) * first.shape->radius +
         turned(then.second, second.orientation) * second.shape->radius;
}

}  // namespace

PairPose pose_of(const PairBody& first, const PairBody& second) {
  return {(first.position - second.position).cast<float>(), first.orientation.coeffs().cast<float>(),
          second.orientation.coeffs().cast<float>()};
}

double find_motion_since(const PairPose& then, const PairBody& first, const PairBody& second) {
  return (first.position - second.position - then.apart.cast<double>()).norm() +
         find_turning_since(then, first, second);
}

GapLeft find_gap_left(const HullGap& found, const PairPose& then, const PairBody& first,
                      const PairBody& second) {
  const Vec3 moved = first.position - second.position - then.apart.cast<double>();
  const double turned = find_turning_since(then, first, second);
  return {found.gap - moved.norm() - turned, found.gap + moved.dot(found.normal) - turned};
}

double look_along(HullGap& found, const PairBody& first, const PairBody& second) {
  const auto reach_along = [](const PairBody& body, const Vec3& direction, std::int32_t& vertex) {
    if (body.shape->sphere_radius) return *body.shape->sphere_radius;
    const Vec3 own = body.orientation.conjugate() * direction;
    if (vertex < 0) vertex = body.shape->support_map.find_start(own);
    vertex = find_support(body.shape->hull, own, vertex);
    return own.dot(body.shape->hull.vertices[std::size_t(vertex)]);
  };
  found.gap = found.normal.dot(first.position - second.position) -
              reach_along(first, -found.normal, found.vertex_first) -
              reach_along(second, found.normal, found.vertex_second);
  return found.gap;
}

HeldContact hold(const PairContact& contact, const PairBody& first, const PairBody& second) {
  HeldContact held{contact.normal, contact.manifold.count, {}, {}};
  for (int i = 0; i < contact.manifold.count; ++i) {
    const ManifoldPoint& p = contact.manifold.points[std::size_t(i)];
    const Vec3 half = 0.5 * p.gap * contact.normal;
    held.on_first[std::size_t(i)] =
        (first.orientation.conjugate() * (p.point + half - first.position)).cast<float>();
    held.on_second[std::size_t(i)] =
        (second.orientation.conjugate() * (p.point - half - second.position)).cast<float>();
  }
  return held;
}

// A ball rolls over its contact: that stays under its centre, where a point that turns with it would push it
// from behind.
PairContact follow(const HeldContact& held, const PairBody& first, const PairBody& second) {
  const std::optional<double>&first_ball = first.shape->sphere_radius,
        &second_ball = second.shape->sphere_radius;
  const Mat3 turn_first = first.orientation.toRotationMatrix(),
             turn_second = second.orientation.toRotationMatrix();
  const Vec3 apart = first.position - second.position;
  PairContact contact{
      first_ball && second_ball && apart.squaredNorm() > 0.0 ? Vec3(apart.normalized()) : held.normal,
      1e300,
      {}};
  const Vec3& normal = contact.normal;
  contact.manifold.count = held.count;
  for (int i = 0; i < held.count; ++i) {
    Vec3 on_first = first.position, on_second = second.position;
    on_first += first_ball ? Vec3(-*first_ball * normal)
                           : Vec3(turn_first * held.on_first[std::size_t(i)].cast<double>());
    on_second += second_ball ? Vec3(*second_ball * normal)
                             : Vec3(turn_second * held.on_second[std::size_t(i)].cast<double>());
    const double gap = (on_first - on_second).dot(normal);
    if (first_ball)
      on_second = on_first - gap * normal;
    else if (second_ball)
      on_first = on_second + gap * normal;
    contact.manifold.points[std::size_t(i)] = {0.5 * (on_first + on_second), gap};
    contact.gap = std::min(contact.gap, gap);
  }
  return contact;
}

}  // namespace lodestone
