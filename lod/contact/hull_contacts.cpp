#include "lod/contact/hull_contacts.h"

#include <algorithm>

#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

// Vertices of the hull below the margin, found by walking its edges from the lowest one: below a plane they
// are connected.
struct Submerged {
  static constexpr int kCapacity = 64;
  std::array<std::int32_t, kCapacity> vertex;
  std::array<double, kCapacity> gap;
  int count = 0;
  std::size_t vertices;  // of the hull

  // Marks by the vertex's low bits tell newcomers at once; where so many vertices share marks, the list
  // decides.
  static constexpr std::uint32_t kMarks = 2048;
  std::array<std::uint64_t, kMarks / 64> marks;
  explicit Submerged(std::size_t of_hull) : vertices(of_hull) {
    std::fill_n(marks.begin(), std::min<std::size_t>(kMarks, of_hull + 63) / 64, 0);
  }
  bool holds(std::int32_t v) const {
    if (!(marks[std::uint32_t(v) % kMarks / 64] >> std::uint32_t(v) % 64 & 1)) return false;
    return vertices <= kMarks ||
           std::find(vertex.begin(), vertex.begin() + count, v) != vertex.begin() + count;
  }
  void add(std::int32_t v, double height) {
    marks[std::uint32_t(v) % kMarks / 64] |= std::uint64_t(1) << std::uint32_t(v) % 64;
    vertex[count] = v;
    gap[count++] = height;
  }
};

void walk_below(const Shape& shape, const Vec3& normal_in_body, double height, double margin,
                Submerged& found) {
  for (int visited = 0; visited < found.count; ++visited) {
    for (const std::int32_t next : shape.hull.neighbors(found.vertex[visited])) {
      if (found.count == Submerged::kCapacity) return;
      const double gap = height + shape.hull.vertices[next].dot(normal_in_body);
      if (gap >= margin || found.holds(next)) continue;
      found.add(next, gap);
    }
  }
}

// Greatest of `measure` over the submerged vertices, body axes.
template <class Measure>
int find_greatest(const Shape& shape, const Submerged& found, Measure measure) {
  int best = 0;
  double best_value = -1.0;
  for (int i = 0; i < found.count; ++i) {
    const double value = measure(shape.hull.vertices[std::size_t(found.vertex[i])]);
    if (value > best_value) best_value = value, best = i;
  }
  return best;
}

}  // namespace

HullContacts find_hull_contacts(const Shape& shape, const Quat& orientation, const Vec3& normal,
                                double height, double margin, std::int32_t& hint) {
  HullContacts result;
  result.count = 1;
  if (shape.sphere_radius) {
    result.contact[0] = find_lowest_point(shape, orientation, normal, height, hint);
    return result;
  }
  const Vec3 normal_in_body = orientation.conjugate() * normal;
  hint = find_support(shape.hull, -normal_in_body, hint);
  const Vec3 arm = orientation * shape.hull.vertices[std::size_t(hint)];
  result.contact[0] = {arm, height + arm.dot(normal), hint};

  Submerged found(shape.hull.vertices.size());
  found.add(hint, result.contact[0].gap);
  walk_below(shape, normal_in_body, height, margin, found);
  if (found.count == 1) return result;
  const Mat3 rotation = orientation.toRotationMatrix();
  const auto keep = [&](int i) {
    const std::int32_t vertex = found.vertex[i];
    result.contact[result.count++] = {rotation * shape.hull.vertices[std::size_t(vertex)], found.gap[i],
                                      vertex};
  };
  if (found.count <= kMaxGroundContacts) {
    for (int i = 1; i < found.count; ++i) keep(i);
    return result;
  }
  // The widest support: farthest from the lowest, then farthest to either side of the line between those two.
  const Vec3& first = shape.hull.vertices[std::size_t(hint)];
  const int second = find_greatest(shape, found, [&](const Vec3& v) { return (v - first).squaredNorm(); });
  const Vec3 side = normal_in_body.cross(shape.hull.vertices[std::size_t(found.vertex[second])] - first);
  const int left = find_greatest(shape, found, [&](const Vec3& v) { return (v - first).dot(side); });
  const int right = find_greatest(shape, found, [&](const Vec3& v) { return (first - v).dot(side); });
  for (const int i : {second, left, right})
    if (i != 0 && (result.count < 2 || i != second)) keep(i);
  return result;
}

double lift_of(const StatisticalBody& body, const Shape& shape, double gravity, double time) {
  return body.eased > 0.0f ? parting_speed(shape.radius, gravity) * time : 1e300;
}

void lift_out(StatisticalBody& body, const Shape& shape, const HalfSpace& plane, double farthest) {
  const double height = plane.height_of(body.position);
  if (height > shape.radius) return;
  const double gap = find_lowest_point(shape, body.orientation, plane.normal, height, body.support_hint).gap;
  if (gap >= 0.0) return;
  body.position += std::min(-gap, farthest) * plane.normal;
  body.velocity -= std::min(0.0, body.velocity.dot(plane.normal)) * plane.normal;
}

}  // namespace lodestone
