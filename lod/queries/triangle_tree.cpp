#include "lod/queries/triangle_tree.h"

#include <algorithm>
#include <cmath>

#include "reference/mesh/rays.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr std::uint32_t kLeaf = 4;  // triangles

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

TriangleTree::TriangleTree(const Mesh& mesh) {
  for (const auto& f : mesh.faces)
    triangles_.push_back({mesh.vertices[std::size_t(f[0])], mesh.vertices[std::size_t(f[1])],
                          mesh.vertices[std::size_t(f[2])]});
  nodes_.push_back({.begin = 0, .end = std::uint32_t(triangles_.size())});
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node);
}

// At the median, along the longest side.
void TriangleTree::split(std::size_t index) {
  const std::uint32_t begin = nodes_[index].begin, end = nodes_[index].end;
  Box box;
  for (std::uint32_t i = begin; i < end; ++i)
    for (const Vec3& corner : triangles_[i]) box.extend(corner);
  nodes_[index].box = box;
  if (end - begin <= kLeaf) return;
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = (begin + end) / 2;
  const auto place = [&](const Triangle& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                   [&](const Triangle& a, const Triangle& b) { return place(a) < place(b); });
  nodes_[index].left = std::int32_t(nodes_.size());
  nodes_.push_back({.begin = begin, .end = middle});
  nodes_.push_back({.begin = middle, .end = end});
}

template <class Enters, class Visit>
void TriangleTree::walk(const Enters& enters, const Visit& visit) const {
  std::array<std::int32_t, 64> stack;  // halves: no mesh has 2⁶⁴ triangles
  int depth = 0;
  stack[std::size_t(depth++)] = 0;
  while (depth > 0) {
    const Node& node = nodes_[std::size_t(stack[std::size_t(--depth)])];
    if (!enters(node.box)) continue;
    if (node.left >= 0) {
      stack[std::size_t(depth++)] = node.left;
      stack[std::size_t(depth++)] = node.left + 1;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) visit(triangles_[i]);
  }
}

std::optional<SurfaceHit> TriangleTree::cast(const Vec3& from, const Vec3& direction, double length) const {
  double first = length;
  const Triangle* met = nullptr;
  walk([&](const Box& box) { return enters_box(box, 0.0, from, direction, first); },
       [&](const Triangle& t) {
         if (const auto distance = meet_front(t, from, direction, first)) first = *distance, met = &t;
       });
  if (!met) return {};
  return SurfaceHit{first, from + first * direction, normal_of(*met).normalized()};
}

std::optional<SurfaceHit> TriangleTree::sweep(const Vec3& from, const Vec3& direction, double length,
                                              double radius) const {
  std::optional<SurfaceHit> first;
  double reach = length;
  const auto apart = [&](const SurfaceHit& hit) { return (hit.point - from).squaredNorm(); };
  walk(
      [&](const Box& box) { return enters_box(box, radius, from, direction, reach); },
      [&](const Triangle& t) {
        const auto hit = sweep_triangle(t, from, direction, reach, radius);
        if (!hit || (first && first->distance == 0.0 && hit->distance == 0.0 && apart(*hit) >= apart(*first)))
          return;
        first = hit, reach = hit->distance;
      });
  return first;
}

std::optional<SurfaceHit> TriangleTree::find_nearest(const Vec3& point, double reach) const {
  std::optional<SurfaceHit> nearest;
  double square = reach * reach;
  walk([&](const Box& box) { return box.squaredExteriorDistance(point) <= square; },
       [&](const Triangle& t) {
         const Vec3 at = nearest_point(t, point);
         if (const double apart = (at - point).squaredNorm(); apart <= square)
           square = apart, nearest = SurfaceHit{std::sqrt(apart), at, normal_of(t).normalized()};
       });
  return nearest;
}

// An odd number of crossings, along a line that is unlikely to graze an edge.
bool TriangleTree::contains(const Vec3& point) const {
  const Vec3 direction = Vec3(0.5773, 0.2113, 0.7887).normalized();
  if (!nodes_[0].box.contains(point)) return false;
  int crossings = 0;
  const double length = 2.0 * nodes_[0].box.diagonal().norm();
  walk([&](const Box& box) { return enters_box(box, 0.0, point, direction, length); },
       [&](const Triangle& t) {
         crossings += meet_front(t, point, direction, length).has_value() ||
                      meet_back(t, point, direction, length).has_value();
       });
  return crossings % 2 == 1;
}

bool TriangleTree::meets_box(const Vec3& center, const Mat3& axes, const Vec3& half) const {
  const Vec3 reach = axes.cwiseAbs() * half;
  const Box around(center - reach, center + reach);
  bool met = false;
  walk([&](const Box& box) { return !met && around.intersects(box); },
       [&](const Triangle& t) {
         const auto own = [&](const Vec3& p) { return Vec3(axes.transpose() * (p - center)); };
         met = met || meets({own(t[0]), own(t[1]), own(t[2])}, half);
       });
  return met;
}

}  // namespace lodestone
