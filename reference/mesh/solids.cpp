// Meshes of the solids that need no file.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "reference/error.h"
#include "reference/mesh/mesh.h"

namespace lodestone {
namespace {

using Vec2 = Eigen::Vector2d;

void require_length(double length_m, const char* what) {
  if (!(length_m > 0.0) || !std::isfinite(length_m))
    throw InputError(fmt::format("{}: found {} m, expected a positive, finite length", what, length_m));
}

/// `outline` (counter-clockwise in x, y; its first corner sees all others) extruded along z to `height`,
/// centred at z = 0.
Mesh make_prism(std::span<const Vec2> outline, double height) {
  const int n = int(outline.size());
  Mesh mesh;
  for (double z : {-0.5 * height, 0.5 * height})
    for (const Vec2& corner : outline) mesh.vertices.emplace_back(corner.x(), corner.y(), z);
  for (int i = 1; i + 1 < n; ++i) {
    mesh.faces.push_back({0, i + 1, i});
    mesh.faces.push_back({n, n + i, n + i + 1});
  }
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    mesh.faces.push_back({i, next, n + next});
    mesh.faces.push_back({i, n + next, n + i});
  }
  return mesh;
}

Mesh make_icosahedron() {
  const double a = 1.0, b = std::numbers::phi;
  Mesh mesh;
  mesh.vertices = {{-a, b, 0},  {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                   {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

/// Each face split into four at its edges' middles.
Mesh subdivide(const Mesh& mesh) {
  Mesh finer{mesh.vertices, {}};
  std::map<std::pair<int, int>, int> middles;
  auto middle_of = [&](int a, int b) {
    const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), int(finer.vertices.size()));
    if (is_new) finer.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    return place->second;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const int ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
    finer.faces.insert(finer.faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return finer;
}

}  // namespace

Mesh make_box(const Vec3& sides_m) {
  for (double side : sides_m) require_length(side, "box side");
  const double x = 0.5 * sides_m.x(), y = 0.5 * sides_m.y();
  const Vec2 outline[] = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  return make_prism(outline, sides_m.z());
}

Mesh make_sphere(double radius_m, int subdivisions) {
  require_length(radius_m, "sphere radius");
  if (subdivisions < 0 || subdivisions > 7)
    throw_input_error("sphere subdivisions", fmt::to_string(subdivisions), "0 … 7");
  Mesh mesh = make_icosahedron();
  for (int i = 0; i < subdivisions; ++i) {
    for (Vec3& vertex : mesh.vertices) vertex.normalize();
    mesh = subdivide(mesh);
  }
  for (Vec3& vertex : mesh.vertices) vertex *= radius_m / vertex.norm();
  return mesh;
}

Mesh make_l(double leg_a_m, double leg_b_m, double width_m, double thickness_m) {
  for (double length : {leg_a_m, leg_b_m, width_m, thickness_m}) require_length(length, "L side");
  if (width_m >= std::min(leg_a_m, leg_b_m))
    throw InputError(fmt::format("L width: found {} m, expected less than both legs ({} m and {} m)", width_m,
                                 leg_a_m, leg_b_m));
  const double x = 0.5 * leg_a_m, y = 0.5 * leg_b_m, w = width_m;
  const Vec2 outline[] = {{-x + w, -y + w}, {-x + w, y}, {-x, y}, {-x, -y}, {x, -y}, {x, -y + w}};
  return make_prism(outline, thickness_m);
}

Mesh make_needle(double length_m, double radius_m) {
  require_length(length_m, "needle length");
  require_length(radius_m, "needle radius");
  Vec2 outline[6];
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3.0;
    outline[i] = radius_m * Vec2(std::cos(angle), std::sin(angle));
  }
  return make_prism(outline, length_m);
}

}  // namespace lodestone
