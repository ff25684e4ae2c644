#include "lod/contact/contact_manifold.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

/// A point by its place in the touching plane and its height along the normal.
struct Point {
  double x, y, height;
};

double cross(const Point& o, const Point& a, const Point& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}
double squared_distance(const Point& a, const Point& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}
Point between(const Point& a, const Point& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.height + t * (b.height - a.height)};
}

/// A corner, an edge or a convex polygon, counter-clockwise. Two polygons overlap in at most as many corners
/// as both have. What lies beyond `count` is never read: to clear and to copy it would cost more than all
/// else.
struct Feature {
  std::array<Point, 2 * kMostCorners> at;
  int count = 0;
  Feature() {}  // NOLINT: leaves the points as they are
  Feature(const Feature& other) : count(other.count) { std::copy_n(other.at.begin(), count, at.begin()); }
  Feature& operator=(const Feature& other) {
    std::copy_n(other.at.begin(), count = other.count, at.begin());
    return *this;
  }
  void add(const Point& p) {
    if (count < int(at.size())) at[count++] = p;
  }
};

/// Two axes that span the touching plane.
struct Plane {
  Vec3 normal, x, y;
  explicit Plane(const Vec3& n) : normal(n), x(n.unitOrthogonal()), y(n.cross(x)) {}
  Point to_plane(const Vec3& v) const { return {v.dot(x), v.dot(y), v.dot(normal)}; }
  Vec3 to_world(const Point& p) const { return p.x * x + p.y * y + p.height * normal; }
};

double area(const Feature& f) {
  double twice = 0.0;
  for (int i = 1; i + 1 < f.count; ++i) twice += cross(f.at[0], f.at[i], f.at[i + 1]);
  return 0.5 * twice;
}

// A polygon so thin that its plane is uncertain becomes the edge between its ends.
void thin_to_edge(Feature& f) {
  if (f.count < 3) return;
  int end = 1;
  for (int i = 2; i < f.count; ++i)
    if (squared_distance(f.at[0], f.at[i]) > squared_distance(f.at[0], f.at[end])) end = i;
  if (area(f) > 1e-3 * squared_distance(f.at[0], f.at[end])) return;
  f.at[1] = f.at[end];
  f.count = 2;
}

// Convex hull in the plane (Andrew's monotone chain); points on a line leave its two ends.
Feature find_outline(std::span<const Vec3> corners, const Plane& plane) {
  const auto before = [](const Point& a, const Point& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  const int count = std::min(int(corners.size()), kMostCorners);
  std::array<Point, kMostCorners> sorted;
  for (int i = 0; i < count; ++i) {
    const Point corner = plane.to_plane(corners[std::size_t(i)]);
    int place = i;
    for (; place > 0 && before(corner, sorted[place - 1]); --place) sorted[place] = sorted[place - 1];
    sorted[place] = corner;
  }
  Feature outline;
  if (count == 1) {
    outline.add(sorted[0]);
    return outline;
  }
  const auto extend = [&outline](const Point& p, int keep) {
    while (outline.count > keep &&
           cross(outline.at[outline.count - 2], outline.at[outline.count - 1], p) <= 0.0)
      --outline.count;
    outline.add(p);
  };
  for (int i = 0; i < count; ++i) extend(sorted[i], 1);
  const int lower = outline.count;
  for (int i = count - 2; i >= 0; --i) extend(sorted[i], lower);
  --outline.count;  // the first point again
  thin_to_edge(outline);
  return outline;
}

// What of `subject` lies to the left of the edge from a to b.
void cut(const Feature& subject, const Point& a, const Point& b, Feature& left) {
  const double slack = 1e-6 * squared_distance(a, b);
  left.count = 0;
  double q_side = cross(a, b, subject.at[0]) + slack;
  for (int i = 0; i < subject.count; ++i) {
    const Point &p = subject.at[i], &q = subject.at[i + 1 < subject.count ? i + 1 : 0];
    const double p_side = q_side;
    q_side = cross(a, b, q) + slack;
    if (p_side >= 0.0) left.add(p);
    const bool has_edge = subject.count > 2 || (subject.count == 2 && i == 0);
    if (has_edge && (p_side < 0.0) != (q_side < 0.0)) left.add(between(p, q, p_side / (p_side - q_side)));
  }
}

Feature clip(const Feature& subject, const Feature& polygon) {
  Feature clipped = subject, next;
  for (int i = 0; i < polygon.count && clipped.count > 0; ++i) {
    cut(clipped, polygon.at[i], polygon.at[i + 1 < polygon.count ? i + 1 : 0], next);
    clipped = next;
  }
  return clipped;
}

// Where two edges cross, if they do; a corner with an edge or a corner touches in the corner.
Feature cross_thin(const Feature& a, const Feature& b) {
  Feature crossing;
  if (a.count == 1 || b.count == 1) {
    crossing.add(a.count == 1 ? a.at[0] : b.at[0]);
    return crossing;
  }
  const double from = cross(b.at[0], b.at[1], a.at[0]), to = cross(b.at[0], b.at[1], a.at[1]);
  if (from == to) return crossing;  // parallel
  crossing.add(between(a.at[0], a.at[1], std::clamp(from / (from - to), 0.0, 1.0)));
  return crossing;
}

// The height of a feature's surface over the touching plane: constant, along the edge, or on the plane of the
// polygon.
class Surface {
 public:
  explicit Surface(const Feature& f) : count_(f.count), first_(f.at[0]), second_(f.at[0]) {
    if (f.count == 2) {
      second_ = f.at[1];
      x_ = second_.x - first_.x, y_ = second_.y - first_.y;
      const double length = x_ * x_ + y_ * y_;
      per_length_ = length > 0.0 ? 1.0 / length : 0.0;
    } else if (f.count > 2) {
      find_plane(f);
    }
  }
  double height_at(const Point& p) const {
    if (count_ == 1) return first_.height;
    if (count_ > 2) return first_.height - (x_ * (p.x - first_.x) + y_ * (p.y - first_.y));
    const double along = ((p.x - first_.x) * x_ + (p.y - first_.y) * y_) * per_length_;
    return between(first_, second_, std::clamp(along, 0.0, 1.0)).height;
  }

 private:
  // Through the middle of the corners, with the mean of what each three of them say (Newell).
  void find_plane(const Feature& f) {
    const auto vec = [](const Point& v) { return Vec3(v.x, v.y, v.height); };
    const Vec3 origin = vec(f.at[0]);
    Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
    for (int i = 1; i < f.count; ++i) {
      const Vec3 from = vec(f.at[i]) - origin;
      middle += from;
      if (i + 1 < f.count) normal += from.cross(vec(f.at[i + 1]) - origin);
    }
    middle = origin + middle / f.count;
    first_ = {middle.x(), middle.y(), middle.z()};
    x_ = normal.x() / normal.z(), y_ = normal.y() / normal.z();
  }

  int count_;
  Point first_, second_;  // of a polygon: its middle; of an edge: its ends
  double x_ = 0.0, y_ = 0.0, per_length_ = 0.0;
};

// Keeps the first point and those that span the widest area with it.
void keep_four(Feature& f) {
  if (f.count <= 4) return;
  const auto greatest = [&f](const auto& measure) {
    return *std::max_element(f.at.begin(), f.at.begin() + f.count,
                             [&](const Point& a, const Point& b) { return measure(a) < measure(b); });
  };
  const Point first = f.at[0];
  const Point second = greatest([&](const Point& p) { return squared_distance(first, p); });
  const Point left = greatest([&](const Point& p) { return cross(first, second, p); });
  const Point right = greatest([&](const Point& p) { return -cross(first, second, p); });
  f.at[1] = second, f.at[2] = left, f.at[3] = right;
  f.count = 4;
}

}  // namespace

Manifold find_manifold(std::span<const Vec3> upper, std::span<const Vec3> lower, const Vec3& normal,
                       double least_gap) {
  const Plane plane(normal);
  const Feature above = find_outline(upper, plane), below = find_outline(lower, plane);
  const bool above_is_face = above.count > 2, below_is_face = below.count > 2;
  Feature overlap;
  if (!above_is_face && !below_is_face)
    overlap = cross_thin(above, below);
  else if (above_is_face && (!below_is_face || area(above) > area(below)))
    overlap = clip(below, above);
  else
    overlap = clip(above, below);
  keep_four(overlap);

  Manifold manifold;
  const Surface upper_surface(above), lower_surface(below);
  for (int i = 0; i < overlap.count; ++i) {
    Point p = overlap.at[i];
    const double top = upper_surface.height_at(p), bottom = lower_surface.height_at(p);
    p.height = 0.5 * (top + bottom);
    manifold.points[manifold.count++] = {plane.to_world(p), std::max(least_gap, top - bottom)};
  }
  return manifold;
}

Manifold join_manifolds(const Manifold& first, const Manifold& second, const Vec3& normal) {
  const Plane plane(normal);
  std::array<ManifoldPoint, 8> all;
  Feature corners;
  for (const Manifold* part : {&first, &second})
    for (int i = 0; i < part->count; ++i) {
      all[std::size_t(corners.count)] = part->points[std::size_t(i)];
      Point corner = plane.to_plane(part->points[std::size_t(i)].point);
      corner.height = corners.count;  // which it is
      corners.add(corner);
    }
  // keep_four spans its area from the first, which must lie outermost: no other has so small an x.
  std::iter_swap(corners.at.begin(),
                 std::min_element(corners.at.begin(), corners.at.begin() + corners.count,
                                  [](const Point& a, const Point& b) { return a.x < b.x; }));
  keep_four(corners);
  Manifold joined;
  for (int i = 0; i < corners.count; ++i)
    joined.points[std::size_t(joined.count++)] = all[std::size_t(corners.at[std::size_t(i)].height)];
  return joined;
}

}  // namespace lodestone
