#include "lod/queries/triangle_questions.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

Vec3 normal_of(const std::array<Vec3, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

// Ericson 5.1.5.
Vec3 nearest_point(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return t[0];
  const Vec3 bp = p - t[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return t[0] + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - t[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double sum = va + vb + vc;
  return t[0] + vb / sum * ab + vc / sum * ac;
}

bool is_within(const std::array<Vec3, 3>& t, const Vec3& normal, const Vec3& p) {
  for (std::size_t i = 0; i < 3; ++i)
    if ((t[(i + 1) % 3] - t[i]).cross(p - t[i]).dot(normal) < 0.0) return false;
  return true;
}

// Of a ray into a cylinder about the segment, without its ends.
std::optional<double> meet_edge(const Vec3& from, const Vec3& direction, double length, const Vec3& begin,
                                const Vec3& end, double radius) {
  const Vec3 axis = end - begin, to = from - begin;
  const double square = axis.squaredNorm();
  if (square == 0.0) return {};
  const Vec3 across = direction - direction.dot(axis) / square * axis,
             off = to - to.dot(axis) / square * axis;
  const double a = across.squaredNorm(), b = off.dot(across), c = off.squaredNorm() - radius * radius,
               root = b * b - a * c;
  if (a < 1e-18 || root < 0.0) return {};
  const double distance = (-b - std::sqrt(root)) / a;
  if (distance < 0.0 || distance > length) return {};
  const double along = (to + distance * direction).dot(axis) / square;
  return along >= 0.0 && along <= 1.0 ? std::optional(distance) : std::nullopt;
}

std::optional<SurfaceHit> sweep_triangle(const std::array<Vec3, 3>& t, const Vec3& from,
                                         const Vec3& direction, double length, double radius) {
  const Vec3 nearest = nearest_point(t, from);
  if (const double apart = (from - nearest).norm(); apart <= radius)
    return SurfaceHit{0.0, nearest,
                      apart > 0.0 ? Vec3((from - nearest) / apart) : Vec3(normal_of(t).normalized())};
  double first = length;
  std::optional<Vec3> center;
  const auto take = [&](std::optional<double> distance) {
    if (distance && *distance <= first) first = *distance, center = from + *distance * direction;
  };
  const Vec3 normal = normal_of(t).normalized();
  const double height = normal.dot(from - t[0]), side = height >= 0.0 ? 1.0 : -1.0,
               falling = -side * normal.dot(direction);
  if (falling > 0.0) {
    const double distance = (std::abs(height) - radius) / falling;
    if (distance >= 0.0 && is_within(t, normal, from + distance * direction)) take(distance);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    take(meet_edge(from, direction, first, t[i], t[(i + 1) % 3], radius));
    take(meet_sphere(from, direction, first, t[i], radius));
  }
  if (!center) return {};
  const Vec3 point = nearest_point(t, *center);
  return SurfaceHit{first, point, (*center - point).normalized()};
}

bool is_apart_along(const Vec3& axis, const std::array<Vec3, 3>& t, const Vec3& half) {
  const double a = t[0].dot(axis), b = t[1].dot(axis), c = t[2].dot(axis), reach = half.dot(axis.cwiseAbs());
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

// Of a box about the origin, along the axes.
bool meets(const std::array<Vec3, 3>& t, const Vec3& half) {
  const std::array<Vec3, 3> edges{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  for (int a = 0; a < 3; ++a) {
    if (is_apart_along(Vec3::Unit(a), t, half)) return false;
    for (const Vec3& edge : edges)
      if (is_apart_along(Vec3::Unit(a).cross(edge), t, half)) return false;
  }
  return !is_apart_along(normal_of(t), t, half);
}

}  // namespace

std::optional<double> meet_sphere(const Vec3& from, const Vec3& direction, double length, const Vec3& center,
                                  double radius) {
  const Vec3 to = from - center;
  const double b = to.dot(direction), c = to.squaredNorm() - radius * radius;
  if (c <= 0.0) return 0.0;
  const double root = b * b - c;
  if (b > 0.0 || root < 0.0) return {};
  const double distance = -b - std::sqrt(root);
  return distance <= length ? std::optional(std::max(0.0, distance)) : std::nullopt;
}

void FirstMet::ask(const Triangle& t) {
  if (radius_ > 0.0) return sweep(t);
  const auto distance = meet_front(t, from_, direction_, reach_);
  if (!distance) return;
  reach_ = *distance;
  hit_ = SurfaceHit{reach_, from_ + reach_ * direction_, normal_of(t).normalized()};
}

// Of those that are touched at the start, the one with the nearest point.
void FirstMet::sweep(const Triangle& t) {
  const auto apart = [&](const SurfaceHit& hit) { return (hit.point - from_).squaredNorm(); };
  const auto hit = sweep_triangle(t, from_, direction_, reach_, radius_);
  if (!hit || (hit_ && hit_->distance == 0.0 && hit->distance == 0.0 && apart(*hit) >= apart(*hit_))) return;
  hit_ = hit, reach_ = hit->distance;
}

void NearestPoint::ask(const Triangle& t) {
  const Vec3 at = nearest_point(t, point_);
  const double apart = (at - point_).squaredNorm();
  if (apart <= square_) square_ = apart, hit_ = SurfaceHit{std::sqrt(apart), at, normal_of(t).normalized()};
}

void MeetsBox::ask(const Triangle& t) {
  const auto own = [&](const Vec3& p) { return Vec3(axes_.transpose() * (p - center_)); };
  if (!met_ && meets({own(t[0]), own(t[1]), own(t[2])}, half_)) met_ = nearest_point(t, center_);
}

void Crossings::ask(const Triangle& t) {
  crossings_ += meet_front(t, from_, direction_, length_).has_value() ||
                meet_back(t, from_, direction_, length_).has_value();
}

}  // namespace lodestone
