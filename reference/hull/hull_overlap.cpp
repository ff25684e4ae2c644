#include "reference/hull/hull_overlap.h"

#include <ccd/ccd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace lodestone {
namespace {

constexpr double kShallow = 0.01;  // × radius: a way out that is shorter is the shortest

/// A shape in the world as libccd asks for it.
struct PlacedHull {
  const Shape* shape;
  RigidState state;
  Mat3 axes = state.orientation.toRotationMatrix();
  mutable int last = 0;  // vertex found before: the next one is mostly near it

  int farthest_vertex(const Vec3& direction) const {
    return last = find_support(shape->hull, axes.transpose() * direction, last);
  }
  /// The farthest point along `direction` (any length), relative to the centre of mass.
  Vec3 farthest_offset(const Vec3& direction) const {
    if (shape->sphere_radius) return *shape->sphere_radius * direction.normalized();
    return axes * shape->hull.vertices[farthest_vertex(direction)];
  }
  Vec3 farthest(const Vec3& direction) const { return state.position + farthest_offset(direction); }
};

Vec3 to_vec3(const ccd_vec3_t& v) { return {v.v[0], v.v[1], v.v[2]}; }
void assign(ccd_vec3_t& to, const Vec3& v) {
  ccdVec3Set(&to, ccd_real_t(v.x()), ccd_real_t(v.y()), ccd_real_t(v.z()));
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  assign(*point, static_cast<const PlacedHull*>(object)->farthest(to_vec3(*direction)));
}

void center(const void* object, ccd_vec3_t* point) {
  assign(*point, static_cast<const PlacedHull*>(object)->state.position);
}

/// The point (m) of the Minkowski difference, second − first, that is farthest along `direction`. So far they
/// overlap that way.
Vec3 farthest_between(const PlacedHull& first, const PlacedHull& second, const Vec3& direction) {
  return second.farthest(direction) - first.farthest(-direction);
}

/// Of a body's hull around its vertex farthest along `direction`, in the world.
struct Corner {
  std::vector<Vec3> normals, edges;

  void find(const PlacedHull& body, const Vec3& direction) {
    normals.clear(), edges.clear();
    if (body.shape->sphere_radius) return;
    const Hull& hull = body.shape->hull;
    const int vertex = body.farthest_vertex(direction);
    for (const int face : hull.faces_of(vertex)) normals.push_back(body.axes * hull.area_vector(face));
    for (const int other : hull.neighbors(vertex))
      edges.push_back(body.axes * (hull.vertices[other] - hull.vertices[vertex]));
  }
};

/// From a direction to the best of its neighbours among the normals of the Minkowski difference (a face of
/// one body, or an edge of each), and on, until none is better.
class Walk {
 public:
  Walk(const PlacedHull& first, const PlacedHull& second, const Vec3& start)
      : first_(first), second_(second) {
    best_ = {measure(start), start};
  }

  HullOverlap end() {
    constexpr int kMostSteps = 64;
    for (int i = 0; i < kMostSteps && step(); ++i) {
    }
    return best_;
  }

 private:
  bool step() {
    const double before = best_.depth;
    const Vec3 from = best_.direction;
    thread_local Corner first, second;
    first.find(first_, -from), second.find(second_, from);
    for (const Vec3& normal : first.normals) consider(-normal, from);
    for (const Vec3& normal : second.normals) consider(normal, from);
    for (const Vec3& a : first.edges)
      for (const Vec3& b : second.edges) consider(a.cross(b), from);
    return best_.depth < before;
  }
  void consider(const Vec3& raw, const Vec3& from) {
    constexpr double kParallel = 1e-20;  // squared
    const double size = raw.squaredNorm();
    if (!(size > kParallel * first_.shape->radius * second_.shape->radius)) return;
    const Vec3 direction = (raw.dot(from) < 0.0 ? -raw : raw) / std::sqrt(size);
    if (is_deeper(direction)) return;
    const double depth = measure(direction);
    if (depth < best_.depth) best_ = {depth, direction};
  }
  double measure(const Vec3& direction) {
    const Vec3 between = farthest_between(first_, second_, direction);
    known_[known_count_++ % known_.size()] = between;
    return between.dot(direction);
  }
  // Than the best, as points show that were found along other directions: no overlap is less than what lies
  // between any two points. Most directions need no search for their own.
  bool is_deeper(const Vec3& direction) const {
    constexpr double kRounding = 1e-12;  // × radius
    const double enough = best_.depth + kRounding * first_.shape->radius;
    const auto known = std::span(known_).first(std::min(known_count_, known_.size()));
    return std::ranges::any_of(known, [&](const Vec3& between) { return between.dot(direction) > enough; });
  }

  const PlacedHull &first_, &second_;
  HullOverlap best_;
  std::array<Vec3, 16> known_;  // m, the last ones
  std::size_t known_count_ = 0;
};

using Search = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

/// Unit, from the second centre to the first; any where they are one.
Vec3 way_between(const PlacedHull& first, const PlacedHull& second) {
  const Vec3 between = first.state.position - second.state.position;
  const double distance = between.norm();
  return distance > 0.0 ? Vec3(between / distance) : Vec3::UnitZ();
}

/// Where libccd says that the two overlap, a direction along which the first leaves the second by about the
/// shortest way.
std::optional<Vec3> find_way_out(const PlacedHull& first, const PlacedHull& second, Search search) {
  ccd_t query;
  CCD_INIT(&query);
  query.support1 = query.support2 = support;
  query.center1 = query.center2 = center;
  query.max_iterations = 100;
  query.mpr_tolerance = query.epa_tolerance =
      ccd_real_t(1e-6 * std::min(first.shape->radius, second.shape->radius));
  ccd_real_t depth = 0;
  ccd_vec3_t out, point;
  if (search(&first, &second, &query, &depth, &out, &point) != 0) return {};
  const Vec3 direction = -to_vec3(out);
  const double norm = direction.norm();
  if (!std::isfinite(norm)) return way_between(first, second);  // they overlap, but it found no way
  if (norm <= 0.5) return {};
  return direction / norm;
}

/// Around the first's place, so that nothing is lost far from the origin.
struct PlacedPair {
  PlacedHull first, second;

  PlacedPair(const Shape& a, const RigidState& state_of_a, const Shape& b, const RigidState& state_of_b)
      : first{&a, state_of_a}, second{&b, state_of_b} {
    second.state.position -= first.state.position;
    first.state.position.setZero();
  }
  bool are_spheres() const { return first.shape->sphere_radius && second.shape->sphere_radius; }
};

/// `between`: from the second centre to the first.
std::optional<HullOverlap> find_sphere_overlap(double radii, const Vec3& between) {
  const double distance = between.norm();
  if (distance >= radii) return {};
  return HullOverlap{radii - distance, distance > 0.0 ? Vec3(between / distance) : Vec3::UnitZ()};
}

template <class Visit>
void each_piece(const Shape& shape, const RigidState& state, const Visit& visit) {
  if (shape.pieces.empty()) return visit(shape, state);
  for (const Shape& piece : shape.pieces) {
    RigidState at = state;
    at.position += state.orientation * piece.center_of_mass_in_mesh;
    visit(piece, at);
  }
}

}  // namespace

bool may_hulls_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                       const RigidState& second_state) {
  const PlacedPair pair(first, first_state, second, second_state);
  return pair.are_spheres() || find_way_out(pair.first, pair.second, ccdMPRPenetration);
}

std::optional<HullOverlap> find_hull_overlap(const Shape& first, const RigidState& first_state,
                                             const Shape& second, const RigidState& second_state) {
  const PlacedPair pair(first, first_state, second, second_state);
  const PlacedHull &a = pair.first, &b = pair.second;
  if (pair.are_spheres())
    return find_sphere_overlap(*first.sphere_radius + *second.sphere_radius, -b.state.position);
  // The portal tells best whether the hulls overlap, but may be misled about the way out where they do so by
  // far; the polytope now and then.
  const auto by_portal = find_way_out(a, b, ccdMPRPenetration);
  if (!by_portal) return {};
  HullOverlap least = Walk(a, b, *by_portal).end();
  if (least.depth < kShallow * std::min(first.radius, second.radius))
    return least.depth > 0.0 ? std::optional(least) : std::nullopt;
  if (const auto by_polytope = find_way_out(a, b, ccdGJKPenetration))
    if (const HullOverlap other = Walk(a, b, *by_polytope).end(); other.depth < least.depth) least = other;
  // Of two that touch and hardly overlap both may name the far side of the second. What is less by rounding
  // alone is the same way.
  constexpr double kLess = 0.999;
  const auto try_from = [&](const Vec3& start) {
    if (const HullOverlap other = Walk(a, b, start).end(); other.depth < kLess * least.depth) least = other;
  };
  try_from(-*by_portal);
  try_from(way_between(a, b));
  return least.depth > 0.0 ? std::optional(least) : std::nullopt;
}

double measure_hull_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                            const RigidState& second_state) {
  const auto overlap = find_hull_overlap(first, first_state, second, second_state);
  return overlap ? overlap->depth : 0.0;
}

double measure_pair_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                            const RigidState& second_state, double allowed) {
  const double of_hulls = measure_hull_overlap(first, first_state, second, second_state);
  if (of_hulls <= allowed || (first.pieces.empty() && second.pieces.empty())) return of_hulls;
  double deepest = 0.0;
  each_piece(first, first_state, [&](const Shape& a, const RigidState& at_a) {
    each_piece(second, second_state, [&](const Shape& b, const RigidState& at_b) {
      deepest = std::max(deepest, measure_hull_overlap(a, at_a, b, at_b));
    });
  });
  return deepest;
}

double measure_plane_overlap(const Shape& shape, const RigidState& state, const Vec3& normal, double offset) {
  const PlacedHull placed{&shape, state};
  return offset - normal.dot(state.position + placed.farthest_offset(-normal));
}

}  // namespace lodestone
