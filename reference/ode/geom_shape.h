// A geom of the caller's as plain data, and rays against one that cannot be read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "reference/geometry.h"

struct dxGeom;  // dGeomID is dxGeom*

namespace lodestone {

enum class GeomKind : std::uint8_t {
  plane,
  sphere,
  box,
  capsule,
  cylinder,
  convex,
  trimesh,
  height_field,
  other
};

/// In the geom's own frame, m. A capsule's and a cylinder's axis is z; a capsule's length is without its
/// caps.
struct GeomShape {
  GeomKind kind = GeomKind::other;
  Vec3 sides = Vec3::Zero();          ///< of a box
  double radius = 0.0, length = 0.0;  ///< of a sphere, capsule or cylinder
  /// Of a convex (its corners) or a trimesh (three a face, as ODE gives them out).
  std::vector<Vec3> vertices = {};
  std::vector<std::array<int, 3>> faces = {};  ///< counter-clockwise seen from outside
};

GeomKind kind_of(dxGeom* geom);

/// Planes, height fields and other classes come with their kind alone; so does a convex whose corners lie in
/// a plane.
GeomShape read_geom(dxGeom* geom);

struct RayHit {
  Vec3 point, normal;     ///< m, world; unit, against the ray
  double distance = 0.0;  ///< m from the ray's start
};

/// Casts rays by ODE's own colliders. Not for two threads at once.
class GeomProbe {
 public:
  GeomProbe();
  ~GeomProbe();
  GeomProbe(const GeomProbe&) = delete;
  GeomProbe& operator=(const GeomProbe&) = delete;

  /// The first point of `geom` that a ray of `length` m from `from` along `direction` (unit, world) meets. A
  /// trimesh is met from either side.
  std::optional<RayHit> cast(dxGeom* geom, const Vec3& from, const Vec3& direction, double length);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
