#include "lod/contact/hull_gap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/hull/hull_overlap.h"

namespace lodestone {
namespace {

constexpr double kApart = 0.02;  // over R: so far overlapping hulls are taken apart to look for their axis
// Over R: so little that no other way out is shorter than the one known before.
constexpr double kShallow = 0.02;
// Over the lesser inner radius: an overlap whose least way out may lie elsewhere.
constexpr double kDeep = 0.25;
constexpr int kMostRounds = 32;
constexpr double kConverged = 1e-7;  // of the squared distance

struct Corner {
  Vec3 at;
  HullCorner of;
};

// Points of the difference of the two cores; nearest() leaves those that the point nearest to the origin lies
// between.
class Simplex {
 public:
  bool holds(const Vec3& p) const {
    return std::any_of(corners_.begin(), corners_.begin() + count_,
                       [&](const Corner& other) { return other.at == p; });
  }
  void add(const Corner& corner) { corners_[count_++] = corner; }
  void clear() { count_ = 0; }

  Vec3 nearest() {
    if (count_ == 1) return corners_[0].at;
    if (count_ == 2) return nearest_of_edge(corners_[0], corners_[1]);
    if (count_ == 3) return nearest_of_face(corners_[0], corners_[1], corners_[2]);
    return nearest_of_solid();
  }

  /// Up to three.
  void save(HullGap& gap) const {
    gap.corner_count = std::min(count_, 3);
    for (int i = 0; i < gap.corner_count; ++i) gap.corners[std::size_t(i)] = corners_[std::size_t(i)].of;
  }

 private:
  std::array<Corner, 4> corners_;
  int count_ = 0;

  Vec3 keep(const Corner& a) {
    corners_[0] = a;
    count_ = 1;
    return a.at;
  }

  Vec3 keep(const Corner& a, const Corner& b, double t) {
    corners_[0] = a;
    corners_[1] = b;
    count_ = 2;
    return a.at + t * (b.at - a.at);
  }

  Vec3 nearest_of_edge(const Corner a, const Corner b) {
    const Vec3 ab = b.at - a.at;
    const double along = -a.at.dot(ab), length = ab.squaredNorm();
    if (along <= 0.0) return keep(a);
    if (along >= length) return keep(b);
    return keep(a, b, along / length);
  }

  // By the regions of corners, edges and face (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
  Vec3 nearest_of_face(const Corner a, const Corner b, const Corner c) {
    const Vec3 ab = b.at - a.at, ac = c.at - a.at;
    const double a_ab = -a.at.dot(ab), a_ac = -a.at.dot(ac);
    if (a_ab <= 0.0 && a_ac <= 0.0) return keep(a);
    const double b_ab = -b.at.dot(ab), b_ac = -b.at.dot(ac);
    if (b_ab >= 0.0 && b_ac <= b_ab) return keep(b);
    const double vc = a_ab * b_ac - b_ab * a_ac;
    if (vc <= 0.0 && a_ab >= 0.0 && b_ab <= 0.0) return keep(a, b, a_ab / (a_ab - b_ab));
    const double c_ab = -c.at.dot(ab), c_ac = -c.at.dot(ac);
    if (c_ac >= 0.0 && c_ab <= c_ac) return keep(c);
    const double vb = c_ab * a_ac - a_ab * c_ac;
    if (vb <= 0.0 && a_ac >= 0.0 && c_ac <= 0.0) return keep(a, c, a_ac / (a_ac - c_ac));
    const double va = b_ab * c_ac - c_ab * b_ac, on_bc = b_ac - b_ab, off_bc = c_ab - c_ac;
    if (va <= 0.0 && on_bc >= 0.0 && off_bc >= 0.0) return keep(b, c, on_bc / (on_bc + off_bc));
    corners_[0] = a;
    corners_[1] = b;
    corners_[2] = c;
    count_ = 3;
    const Vec3 normal = ab.cross(ac);
    return (normal.dot(a.at) / normal.squaredNorm()) * normal;
  }

  // The nearest of those faces that part the origin from the fourth corner; none: the origin lies within.
  Vec3 nearest_of_solid() {
    static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    const std::array<Corner, 4> corners = corners_;
    const int* best = nullptr;
    double least = 1e300;
    for (const auto& face : kFaces) {
      const Vec3 &a = corners[face[0]].at, &b = corners[face[1]].at, &c = corners[face[2]].at;
      const Vec3 normal = (b - a).cross(c - a);
      if (-normal.dot(a) * normal.dot(corners[face[3]].at - a) > 0.0) continue;
      if (const double distance =
              nearest_of_face(corners[face[0]], corners[face[1]], corners[face[2]]).squaredNorm();
          distance < least)
        least = distance, best = face;
    }
    return best ? nearest_of_face(corners[best[0]], corners[best[1]], corners[best[2]]) : Vec3(Vec3::Zero());
  }
};

// Spheres have their centre for a core, hulls themselves.
Vec3 core_of(const Shape& shape, const Vec3& arm) { return shape.sphere_radius ? Vec3(Vec3::Zero()) : arm; }

// Of the two when the first is moved by `shift`. Whether their cores are apart then: `gap` is of the hulls
// where they are, along the axis found; else along the best one that was met.
bool find_axis(const PlacedHull& first, const PlacedHull& second, const Vec3& shift, const Enough& enough,
               HullGap& gap) {
  const Vec3 between = first.position - second.position;
  const double size = first.shape->radius + second.shape->radius, nothing = 1e-18 * size * size;
  Simplex simplex;
  HullGap best;
  double square = 1e300;
  // Where the last search ended, this one mostly ends, too.
  for (int i = 0; i < gap.corner_count; ++i) {
    const HullCorner& of = gap.corners[std::size_t(i)];
    simplex.add({between + shift + first.arm_of(of.first) - second.arm_of(of.second), of});
  }
  if (gap.corner_count > 0) {
    const Vec3 nearest = simplex.nearest();
    square = nearest.squaredNorm();
    if (square > nothing)
      gap.normal = nearest / std::sqrt(square);
    else
      simplex.clear(), square = 1e300;
  }
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3 arm_first = first.find_farthest(-gap.normal, gap.vertex_first),
               arm_second = second.find_farthest(gap.normal, gap.vertex_second);
    gap.gap = gap.normal.dot(between + arm_first - arm_second);
    if (gap.gap > enough.along(gap.normal)) return true;
    if (gap.gap > best.gap) best = gap;
    const Vec3 corner =
        between + shift + core_of(*first.shape, arm_first) - core_of(*second.shape, arm_second);
    if (square < 1e300 &&
        (std::sqrt(square) * gap.normal.dot(corner) >= square * (1.0 - kConverged) || simplex.holds(corner)))
      return simplex.save(gap), true;
    simplex.add({corner, {gap.vertex_first, gap.vertex_second}});
    const Vec3 nearest = simplex.nearest();
    const double before = square;
    square = nearest.squaredNorm();
    if (!(square > nothing)) return gap = best, false;
    if (square >= before) return simplex.save(gap), true;  // rounding's end
    gap.normal = nearest / std::sqrt(square);
  }
  return gap = best, true;
}

Vec3 from_line_of_centers(const PlacedHull& first, const PlacedHull& second) {
  const Vec3 line = first.position - second.position;
  return line.norm() > 1e-12 ? Vec3(line.normalized()) : Vec3::UnitZ();
}

// Taken apart along an axis that is nearly right, they show a better one.
HullGap find_axis_of_overlap(const PlacedHull& first, const PlacedHull& second, HullGap best,
                             const Enough& enough) {
  constexpr int kMostTries = 4;
  const double apart = kApart * std::min(first.shape->radius, second.shape->radius);
  for (int i = 0; i < kMostTries; ++i) {
    HullGap next = best;
    const bool found = find_axis(first, second, (apart - best.gap) * best.normal, enough, next);
    if (!found || next.gap <= best.gap + 1e-3 * apart) return found && next.gap > best.gap ? next : best;
    best = next;
  }
  return best;
}

}  // namespace

Vec3 PlacedHull::find_farthest(const Vec3& direction, std::int32_t& vertex) const {
  if (shape->sphere_radius) return *shape->sphere_radius * direction;
  const Vec3 own = rotation.transpose() * direction;
  if (vertex < 0) vertex = shape->support_map.find_start(own);
  vertex = find_support(shape->hull, own, vertex);
  return rotation * shape->hull.vertices[std::size_t(vertex)];
}

HullGap measure_hull_gap(const PlacedHull& first, const PlacedHull& second, const Vec3& normal,
                         const HullGap& hints) {
  HullGap along = hints;
  along.normal = normal;
  const Vec3 between = first.position - second.position;
  along.gap = normal.dot(between + first.find_farthest(-normal, along.vertex_first) -
                         second.find_farthest(normal, along.vertex_second));
  return along;
}

HullGap find_hull_gap(const PlacedHull& first, const PlacedHull& second, const HullGap& start,
                      const Enough& enough, bool exact) {
  const bool known = !start.normal.isZero(0.0);
  HullGap gap =
      measure_hull_gap(first, second, known ? start.normal : from_line_of_centers(first, second), start);
  if (gap.gap > enough.along(gap.normal)) return gap;
  // What overlapped a little a moment ago probably does so still.
  if (known && gap.gap < 0.0) {
    gap = find_axis_of_overlap(first, second, gap, enough);
    if (gap.gap < 0.0 && -gap.gap < kShallow * std::min(first.shape->radius, second.shape->radius))
      return gap;
  }
  HullGap other = gap;
  if (find_axis(first, second, Vec3::Zero(), enough, other)) return other;
  other = find_axis_of_overlap(first, second, other, enough);
  if (other.gap > gap.gap) gap = other;
  const auto inner = [](const Shape& shape) {
    return shape.sphere_radius ? *shape.sphere_radius : shape.inner_radius;
  };
  if (!exact || -gap.gap < kDeep * std::min(inner(*first.shape), inner(*second.shape))) return gap;
  const auto overlap = find_hull_overlap(*first.shape, {first.position, first.orientation}, *second.shape,
                                         {second.position, second.orientation});
  return overlap && -overlap->depth > gap.gap ? measure_hull_gap(first, second, overlap->direction, gap)
                                              : gap;
}

bool are_apart(const PlacedHull& first, const PlacedHull& second, const Enough& enough, HullGap& gap) {
  if (gap.normal.isZero(0.0)) gap.normal = from_line_of_centers(first, second);
  return find_axis(first, second, Vec3::Zero(), enough, gap);
}

}  // namespace lodestone
