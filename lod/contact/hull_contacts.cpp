#include "lod/contact/hull_contacts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

// Vertices with a gap below `margin`, now or after the change, in the hull's order.
struct Below {
  static constexpr std::size_t kCapacity = 256;  // of more, the outermost ones serve
  std::array<std::int32_t, kCapacity> vertex;
  std::array<float, kCapacity> x, y, z;  // m, body axes
  std::size_t count = 0;
};

// Those of all ways about the normal, in their order.
void keep_outermost(Below& below, const Vec3& normal) {
  constexpr int kWays = 64;
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::array<bool, Below::kCapacity> is_kept{};
  for (int i = 0; i < kWays; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kWays;
    const Eigen::Vector3f way = (std::cos(angle) * u + std::sin(angle) * v).cast<float>();
    std::size_t best = 0;
    float farthest = -std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < below.count; ++k) {
      const float along = below.x[k] * way[0] + below.y[k] * way[1] + below.z[k] * way[2];
      if (along > farthest) farthest = along, best = k;
    }
    is_kept[best] = true;
  }
  std::size_t count = 0;
  for (std::size_t k = 0; k < below.count; ++k) {
    if (!is_kept[k]) continue;
    below.vertex[count] = below.vertex[k];
    below.x[count] = below.x[k], below.y[count] = below.y[k], below.z[count++] = below.z[k];
  }
  below.count = count;
}

// The lesser gap, now or then, of each vertex.
void find_gaps(const float* x, const float* y, const float* z, std::size_t size,
               const Eigen::Vector3f& normal, float height, const Eigen::Vector3f& of_arm, float of_center,
               float* gap) {
  for (std::size_t i = 0; i < size; ++i) {
    const float change = of_center + x[i] * of_arm[0] + y[i] * of_arm[1] + z[i] * of_arm[2];
    gap[i] = height + x[i] * normal[0] + y[i] * normal[1] + z[i] * normal[2] + std::min(0.0f, change);
  }
}

void find_below(const Hull& hull, const Vec3& normal_in_body, double height, double margin,
                const GapChange& change, Below& below) {
  constexpr std::size_t kBlock = 64;
  std::array<float, kBlock> gap;
  std::array<std::uint8_t, kBlock> is_below;
  const Eigen::Vector3f normal = normal_in_body.cast<float>(), of_arm = change.of_arm.cast<float>();
  const auto limit = float(margin);
  const VertexLanes& lanes = hull.lanes;
  for (std::size_t begin = 0; begin < lanes.x.size(); begin += kBlock) {
    const std::size_t size = std::min(kBlock, lanes.x.size() - begin);
    if (below.count + size > Below::kCapacity) keep_outermost(below, normal_in_body);
    find_gaps(lanes.x.data() + begin, lanes.y.data() + begin, lanes.z.data() + begin, size, normal,
              float(height), of_arm, float(change.of_center), gap.data());
    std::fill(gap.begin() + std::ptrdiff_t(size), gap.end(), limit);
    for (std::size_t i = 0; i < kBlock; ++i) is_below[i] = std::uint8_t(gap[i] < limit);
    for (std::size_t eight = 0; eight < size; eight += 8) {
      std::uint64_t flags;  // a byte each
      std::memcpy(&flags, &is_below[eight], sizeof flags);
      for (; flags != 0; flags &= flags - 1) {
        const std::size_t vertex = begin + eight + std::size_t(std::countr_zero(flags)) / 8;
        below.vertex[below.count] = std::int32_t(vertex);
        below.x[below.count] = lanes.x[vertex];
        below.y[below.count] = lanes.y[vertex];
        below.z[below.count++] = lanes.z[vertex];
      }
    }
  }
}

// The same where no others can be.
void find_below_among(std::span<const std::uint16_t> vertices, const Hull& hull, const Vec3& normal_in_body,
                      double height, double margin, const GapChange& change, Below& below) {
  std::array<float, TipMap::kMost> x, y, z, gap;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    x[i] = hull.lanes.x[vertices[i]], y[i] = hull.lanes.y[vertices[i]], z[i] = hull.lanes.z[vertices[i]];
  find_gaps(x.data(), y.data(), z.data(), vertices.size(), normal_in_body.cast<float>(), float(height),
            change.of_arm.cast<float>(), float(change.of_center), gap.data());
  const auto limit = float(margin);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    below.vertex[below.count] = vertices[i];
    below.x[below.count] = x[i], below.y[below.count] = y[i], below.z[below.count] = z[i];
    below.count += gap[i] < limit;
  }
}

// m: how far short of the lowest vertex, whose gap is `lowest`, one below `margin` now or after the change
// may be. Floats err by less than what is added.
double find_depth(double lowest, double margin, const GapChange& change, double radius) {
  return margin - lowest + std::max(0.0, change.of_arm.norm() * radius - change.of_center) + 1e-5 * radius;
}

// Of all vertices, the lowest of which has the gap `lowest`.
void look_below(const Shape& shape, const Vec3& normal_in_body, double height, double lowest, double margin,
                const GapChange& change, Below& below) {
  std::span<const std::uint16_t> tips;
  if (find_depth(lowest, margin, change, shape.radius) < TipMap::kDepth * shape.radius)
    tips = shape.tips.find(-normal_in_body);
  if (tips.empty())
    find_below(shape.hull, normal_in_body, height, margin, change, below);
  else
    find_below_among(tips, shape.hull, normal_in_body, height, margin, change, below);
}

// Below a plane vertices are connected by edges.
bool is_lowest_alone(const Hull& hull, std::int32_t lowest, const Vec3& normal_in_body, double height,
                     double margin) {
  return std::ranges::none_of(hull.neighbors(lowest), [&](std::int32_t next) {
    return height + hull.vertices[std::size_t(next)].dot(normal_in_body) < margin;
  });
}

// A few vertices in the order in which a walk along edges from the lowest meets them, without that one. Which
// contact a solver meets first matters where it does not converge, as under a slab of a thousand times a
// mass.
std::span<const std::int32_t> around(const Hull& hull, std::int32_t lowest, Below& below) {
  const auto begin = below.vertex.begin(), end = begin + std::ptrdiff_t(below.count);
  auto met = std::ranges::find(begin, end, lowest);
  if (met == end) met = begin;  // it is not below, by rounding
  std::iter_swap(begin, met);
  auto next = begin + (*begin == lowest ? 1 : 0);
  const std::int32_t* const from = below.vertex.data();
  for (auto visited = begin; visited != next && next != end; ++visited)
    for (const std::int32_t neighbor : hull.neighbors(*visited)) {
      const auto found = std::ranges::find(next, end, neighbor);
      if (found != end) std::iter_swap(next++, found);
    }
  return {from + (*begin == lowest ? 1 : 0), below.vertex.data() + below.count};
}

std::int32_t find_greatest(const Below& below, const std::array<float, Below::kCapacity>& value) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < below.count; ++i) best = value[i] > value[best] ? i : best;
  return below.vertex[best];
}

std::int32_t find_farthest(const Below& below, const Eigen::Vector3f& from) {
  std::array<float, Below::kCapacity> square;
  for (std::size_t i = 0; i < below.count; ++i) {
    const float x = below.x[i] - from[0], y = below.y[i] - from[1], z = below.z[i] - from[2];
    square[i] = x * x + y * y + z * z;
  }
  return find_greatest(below, square);
}

// The farthest along `side`, and the farthest the other way.
std::array<std::int32_t, 2> find_ends(const Below& below, const Eigen::Vector3f& side) {
  std::array<float, Below::kCapacity> along, against;
  for (std::size_t i = 0; i < below.count; ++i) {
    along[i] = below.x[i] * side[0] + below.y[i] * side[1] + below.z[i] * side[2];
    against[i] = -along[i];
  }
  return {find_greatest(below, along), find_greatest(below, against)};
}

// The vertex that is lowest once the body has turned.
std::int32_t find_lowest_after(const Below& below, const Vec3& normal_then) {
  const Eigen::Vector3f down = -normal_then.cast<float>();
  std::array<float, Below::kCapacity> depth;
  for (std::size_t i = 0; i < below.count; ++i)
    depth[i] = below.x[i] * down[0] + below.y[i] * down[1] + below.z[i] * down[2];
  return find_greatest(below, depth);
}

}  // namespace

HullContacts find_hull_contacts(const Shape& shape, const Quat& orientation, const Vec3& normal,
                                double height, double margin, std::int32_t& hint, const GapChange& change,
                                const Tipping& tipping) {
  constexpr double kDeeper = 1e-3;  // over R
  HullContacts result;
  result.count = 1;
  result.contact[0] = find_lowest_point(shape, orientation, normal, height, hint);
  if (shape.sphere_radius) return result;
  const std::int32_t lowest = hint;
  const Vec3 normal_in_body = orientation.conjugate() * normal;
  if (change.is_none() && is_lowest_alone(shape.hull, lowest, normal_in_body, height, margin)) return result;
  Below below;
  look_below(shape, normal_in_body, height, result.contact[0].gap, margin, change, below);
  if (below.count == 0) return result;  // as it is in single precision
  const auto keep = [&](std::int32_t vertex) {
    const Vec3 arm = orientation * shape.hull.vertices[std::size_t(vertex)];
    result.contact[std::size_t(result.count++)] = {arm, height + arm.dot(normal), vertex};
  };
  if (below.count <= kMaxGroundContacts) {
    for (const std::int32_t vertex : around(shape.hull, lowest, below))
      if (result.count < kMaxGroundContacts) keep(vertex);
    return result;
  }
  // The widest support: farthest from the lowest, then farthest to either side of the line between those two.
  const Vec3& first = shape.hull.vertices[std::size_t(lowest)];
  const std::int32_t second = find_farthest(below, first.cast<float>());
  const Vec3 side = normal_in_body.cross(shape.hull.vertices[std::size_t(second)] - first);
  keep(second);
  for (const std::int32_t vertex : find_ends(below, side.cast<float>()))
    if (vertex != lowest && vertex != second) keep(vertex);
  if (tipping.is_none()) return result;
  const Vec3 turn = tipping.turn + tipping.by_lever * result.contact[0].arm.cross(normal);
  const Vec3 normal_then = normal_in_body + orientation.conjugate() * normal.cross(turn);
  const std::int32_t then = find_lowest_after(below, normal_then);
  const auto is_deeper_than = [&](const HullContact& contact) {
    const Vec3 between =
        shape.hull.vertices[std::size_t(contact.vertex)] - shape.hull.vertices[std::size_t(then)];
    return between.dot(normal_then) > kDeeper * shape.radius;
  };
  if (std::all_of(result.contact.begin(), result.contact.begin() + result.count, is_deeper_than)) keep(then);
  return result;
}

int find_vertices_below(const Shape& shape, const Vec3& normal, double height, double margin,
                        std::int32_t lowest, std::span<std::int32_t> found) {
  found[0] = lowest;
  if (is_lowest_alone(shape.hull, lowest, normal, height, margin)) return 1;
  Below below;
  const double gap = height + shape.hull.vertices[std::size_t(lowest)].dot(normal);
  look_below(shape, normal, height, gap, margin, {}, below);
  std::size_t count = 1;
  if (below.count < found.size()) {
    for (std::size_t i = 0; i < below.count; ++i)
      if (below.vertex[i] != lowest) found[count++] = below.vertex[i];
    return int(count);
  }
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  for (std::array<float, Below::kCapacity> along; count < found.size(); ++count) {
    const double angle = 2.0 * std::numbers::pi * double(count) / double(found.size() - 1);
    const Eigen::Vector3f way = (std::cos(angle) * u + std::sin(angle) * v).cast<float>();
    for (std::size_t i = 0; i < below.count; ++i)
      along[i] = below.x[i] * way[0] + below.y[i] * way[1] + below.z[i] * way[2];
    found[count] = find_greatest(below, along);
  }
  return int(count);
}

double lift_of(const StatisticalBody& body, const Shape& shape, double gravity, double time) {
  return body.eased > 0.0f ? parting_speed(shape.radius, gravity) * time : 1e300;
}

void lift_out(StatisticalBody& body, const Shape& shape, const HalfSpace& plane, const Vec3& gravity,
              double farthest) {
  const double height = plane.height_of(body.position);
  if (height > shape.radius) return;
  const HullContact lowest =
      find_lowest_point(shape, body.orientation, plane.normal, height, body.support_hint);
  if (lowest.gap >= 0.0) return;
  const double lift = std::min(-lowest.gap, farthest), falling = -body.velocity.dot(plane.normal);
  body.position += lift * plane.normal;
  // No deeper than a hair and fast, it has just arrived: it bounces in the next step.
  constexpr double kHair = 1e-5, kFast = 0.1;  // over R, √(g R)
  const bool arrives =
      lift < kHair * shape.radius && falling * falling > kFast * kFast * gravity.norm() * shape.radius;
  if (falling <= 0.0 || arrives) return;
  const Vec3 omega = angular_velocity(body.orientation, body.spin, shape);
  const double sinking = falling - omega.cross(lowest.arm).dot(plane.normal),
               work = std::max(0.0, -gravity.dot(plane.normal)) * lift,  // J/kg
      raised = falling - std::sqrt(std::max(0.0, falling * falling - 2.0 * work));
  body.velocity += std::max(raised, std::min(falling, sinking)) * plane.normal;
}

}  // namespace lodestone
