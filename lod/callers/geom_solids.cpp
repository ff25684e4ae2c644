#include "lod/callers/geom_solids.h"

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "reference/error.h"

namespace lodestone {
namespace {

constexpr int kAround = 32;  // corners of a circle

// Of a polygon about a circle: its sides lie as far inside as its corners outside.
double outset(int around) { return 2.0 / (1.0 + std::cos(std::numbers::pi / around)); }

void add_circle(std::vector<Vec3>& corners, double radius, double z) {
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kAround;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
}

// Rings from pole to equator, the pole at `z` + radius (or below, for a negative `up`).
void add_half_sphere(std::vector<Vec3>& corners, double radius, double z, double up) {
  constexpr int kRings = kAround / 4;
  const double r = radius * outset(kAround);
  for (int ring = 0; ring < kRings; ++ring) {
    const double angle = 0.5 * std::numbers::pi * ring / kRings;
    add_circle(corners, r * std::cos(angle), z + up * r * std::sin(angle));
  }
  corners.emplace_back(0.0, 0.0, z + up * r);
}

}  // namespace

std::vector<Vec3> corners_of(const GeomShape& geom) {
  std::vector<Vec3> corners;
  switch (geom.kind) {
    case GeomKind::box:
      return make_box(geom.sides).vertices;
    case GeomKind::sphere:
    case GeomKind::capsule: {
      const double half = 0.5 * geom.length;
      add_half_sphere(corners, geom.radius, half, 1.0);
      add_half_sphere(corners, geom.radius, -half, -1.0);
      return corners;
    }
    case GeomKind::cylinder:
      add_circle(corners, geom.radius * outset(kAround), 0.5 * geom.length);
      add_circle(corners, geom.radius * outset(kAround), -0.5 * geom.length);
      return corners;
    case GeomKind::convex:
      return geom.vertices;
    default:
      return {};
  }
}

Mesh mesh_of(const GeomShape& geom) {
  Mesh mesh;
  std::map<std::tuple<double, double, double>, int> known;
  const auto index_of = [&](const Vec3& v) {
    const auto [at, fresh] = known.try_emplace({v.x(), v.y(), v.z()}, int(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(v);
    return at->second;
  };
  for (const auto& [a, b, c] : geom.faces) {
    const std::array<int, 3> face{index_of(geom.vertices[std::size_t(a)]),
                                  index_of(geom.vertices[std::size_t(b)]),
                                  index_of(geom.vertices[std::size_t(c)])};
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) mesh.faces.push_back(face);
  }
  return mesh;
}

GroundSolids solids_of(const GeomShape& geom) {
  GroundSolids solids;
  try {
    if (geom.kind == GeomKind::sphere) {
      solids.add_sphere(geom.radius);
    } else if (geom.kind == GeomKind::trimesh) {
      if (const Mesh mesh = mesh_of(geom); !mesh.faces.empty()) solids.add_mesh(mesh);
    } else if (const std::vector<Vec3> corners = corners_of(geom); corners.size() >= 4) {
      solids.add_hull(corners);
    }
  } catch (const InputError&) {
    return {};  // flat: nothing that a solid could be
  }
  solids.prepare();
  return solids;
}

}  // namespace lodestone
