// Convex hull (Qhull) with its edge graph, and the support function by hill climbing on that graph:
// on a convex polyhedron a vertex none of whose neighbours is farther along a direction is the farthest of
// all.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/geometry.h"
#include "reference/hull/cube_map.h"

namespace lodestone {

/// A hull's vertices in single precision, each coordinate by itself, for loops over all of them.
struct VertexLanes {
  std::vector<float> x, y, z;  ///< m
};

/// A convex polyhedron. `neighbors(i)` are the vertices that share an edge with vertex i, `faces_of(i)` the
/// faces around it.
struct Hull {
  std::vector<Vec3> vertices;             ///< m, hull corners only
  VertexLanes lanes;                      ///< of `vertices`
  std::vector<std::array<int, 3>> faces;  ///< triangulated, counter-clockwise seen from outside
  std::vector<Vec3> face_normals;         ///< unit, outward, of each of `faces`
  /// Size vertices + 1: where each vertex's run of `neighbor` begins.
  std::vector<std::int32_t> neighbor_start;
  std::vector<std::int32_t> neighbor;
  /// Size vertices + 1: where each vertex's run of `incident_face` begins.
  std::vector<std::int32_t> face_start;
  std::vector<std::int32_t> incident_face;

  std::span<const std::int32_t> neighbors(int vertex) const {
    return {neighbor.data() + neighbor_start[vertex], neighbor.data() + neighbor_start[vertex + 1]};
  }
  std::span<const std::int32_t> faces_of(int vertex) const {
    return {incident_face.data() + face_start[vertex], incident_face.data() + face_start[vertex + 1]};
  }
  /// Outward, twice the face's area long, m².
  Vec3 area_vector(int face) const {
    const auto& [a, b, c] = faces[face];
    return (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
  }
};

/// The hull of `points`: its corners only, in the order of `points`; what stands out from the rest by less
/// than 1e-10 × size is no corner. Throws InputError where they lie in a plane or are fewer than four.
Hull make_hull(std::span<const Vec3> points);

/// Of a triangle, counter-clockwise seen from outside, and its corners each moved by its own of `below`, all
/// one way, into the solid: vertices 0, 2, 4 are its corners, and each next one lies below. Takes a fiftieth
/// of make_hull's time.
Hull make_prism_hull(const std::array<Vec3, 3>& corners, const std::array<Vec3, 3>& below);

/// Moves the hull's `origin` to zero, then scales it.
void transform_hull(Hull& hull, const Vec3& origin, double factor);

/// Index of the vertex farthest along `direction` (any length), climbing from `start`. Exact to rounding:
/// 1e-11 × size at worst, where `direction` is normal to a face with a thousand corners, else 1e-15.
/// Direction zero or not finite: some vertex.
int find_support(const Hull& hull, const Vec3& direction, int start = 0);

/// For a direction, a vertex near the farthest one: a start for the climb, which is then exact.
class SupportMap {
 public:
  SupportMap() = default;
  explicit SupportMap(const Hull& hull, int side = 32);
  int find_start(const Vec3& direction) const { return vertices_[std::size_t(cells_.cell_of(direction))]; }
  std::span<const std::uint16_t> vertices() const { return vertices_; }  ///< by cell

 private:
  CubeMap cells_;
  std::vector<std::uint16_t> vertices_;
};

/// What looking up the map without the climb would cost: support height missed, m, over directions even on
/// the sphere.
struct SupportMapError {
  double mean = 0.0, greatest = 0.0;
};
SupportMapError find_lookup_error(const Hull& hull, const SupportMap& map);

}  // namespace lodestone
