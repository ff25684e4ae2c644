#include "tools/compare/solid_meshes.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "reference/error.h"
#include "reference/hull/hull.h"
#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Vec3 on_circle(double radius, double turns, double z) {
  return {radius * std::cos(kTurn * turns), radius * std::sin(kTurn * turns), z};
}

/// `a`, `b`, `c`, `d` counter-clockwise seen from outside.
void add_quad(Mesh& mesh, int a, int b, int c, int d) {
  mesh.faces.push_back({a, b, c});
  mesh.faces.push_back({a, c, d});
}

/// Between two rings of corners about the z axis, given from below, each closed by a fan about its middle.
Mesh make_between_rings(const std::vector<Vec3>& below, const std::vector<Vec3>& above) {
  const int n = int(below.size());
  Mesh mesh{below, {}};
  mesh.vertices.insert(mesh.vertices.end(), above.begin(), above.end());
  mesh.vertices.emplace_back(0.0, 0.0, below[0].z());
  mesh.vertices.emplace_back(0.0, 0.0, above[0].z());
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    add_quad(mesh, i, next, n + next, n + i);
    mesh.faces.push_back({2 * n, next, i});
    mesh.faces.push_back({2 * n + 1, n + i, n + next});
  }
  return mesh;
}

/// Where the grid's planes lie along an axis.
std::vector<double> planes_of(const std::vector<double>& sides) {
  std::vector<double> planes = {0.0};
  for (const double side : sides) planes.push_back(planes.back() + side);
  return planes;
}

class CellMesh {
 public:
  explicit CellMesh(const CellSolid& solid)
      : solid_(solid), planes_{planes_of(solid.x), planes_of(solid.y), planes_of(solid.z)} {}

  Mesh make() {
    for (int k = 0; k < cells(2); ++k)
      for (int j = 0; j < cells(1); ++j)
        for (int i = 0; i < cells(0); ++i)
          if (filled({i, j, k})) add_free_sides({i, j, k});
    return std::move(mesh_);
  }

 private:
  using Cell = std::array<int, 3>;
  int cells(int axis) const { return int(planes_[axis].size()) - 1; }

  bool filled(const Cell& c) const {
    for (int axis = 0; axis < 3; ++axis)
      if (c[axis] < 0 || c[axis] >= cells(axis)) return false;
    return solid_.layers.at(c[2]).at(cells(1) - 1 - c[1]).at(c[0]) == '#';
  }

  void add_free_sides(const Cell& c) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        Cell neighbor = c;
        neighbor[axis] += side ? 1 : -1;
        if (!filled(neighbor)) add_side(c, axis, side);
      }
  }

  // The two other axes in the order that makes them and the outward axis right-handed.
  void add_side(const Cell& c, int axis, int side) {
    const int u = (axis + (side ? 1 : 2)) % 3, v = (axis + (side ? 2 : 1)) % 3;
    const auto corner = [&](int du, int dv) {
      Cell at = c;
      at[axis] += side, at[u] += du, at[v] += dv;
      return vertex(at);
    };
    const int a = corner(0, 0), b = corner(1, 0), d = corner(1, 1), e = corner(0, 1);
    add_quad(mesh_, a, b, d, e);
  }

  int vertex(const Cell& at) {
    const auto [place, is_new] = vertices_.try_emplace(at, int(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.emplace_back(planes_[0][at[0]], planes_[1][at[1]], planes_[2][at[2]]);
    return place->second;
  }

  const CellSolid& solid_;
  std::array<std::vector<double>, 3> planes_;
  std::map<Cell, int> vertices_;
  Mesh mesh_;
};

}  // namespace

Mesh make_torus(double ring_radius, double tube_radius, int around, int across) {
  Mesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const Vec3 section = on_circle(tube_radius, double(j) / across, 0.0);
      mesh.vertices.push_back(on_circle(ring_radius + section.x(), double(i) / around, section.y()));
    }
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const int here = i * across, there = (i + 1) % around * across, next = (j + 1) % across;
      add_quad(mesh, here + j, there + j, there + next, here + next);
    }
  return mesh;
}

Mesh make_star_prism(std::span<const double> radii, double thickness) {
  check_that(radii.size() >= 3, "an outline has three corners", fmt::format("{}", radii.size()));
  std::vector<Vec3> below, above;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    below.push_back(on_circle(radii[i], double(i) / double(radii.size()), -0.5 * thickness));
    above.push_back(on_circle(radii[i], double(i) / double(radii.size()), 0.5 * thickness));
  }
  return make_between_rings(below, above);
}

Mesh make_frustum(int corners, double bottom_radius, double top_radius, double height) {
  std::vector<Vec3> below, above;
  for (int i = 0; i < corners; ++i) {
    below.push_back(on_circle(bottom_radius, double(i) / corners, 0.0));
    above.push_back(on_circle(top_radius, double(i) / corners, height));
  }
  return make_between_rings(below, above);
}

Mesh make_hull_mesh(std::span<const Vec3> points) {
  const Hull hull = make_hull(points);
  return {hull.vertices, hull.faces};
}

Mesh make_random_hull(int points, const Vec3& semi_axes, std::uint64_t seed) {
  std::vector<Vec3> cloud;
  for (int i = 0; i < points; ++i) {
    RandomStream random(seed, std::uint64_t(i), 0);
    const Vec3 direction = random.direction();
    cloud.push_back(std::cbrt(random.uniform()) * semi_axes.cwiseProduct(direction));
  }
  return make_hull_mesh(cloud);
}

Mesh make_cell_mesh(const CellSolid& solid) { return CellMesh(solid).make(); }

}  // namespace lodestone
