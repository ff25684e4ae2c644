#include "reference/ode/callers_shapes_ode.h"

#include "reference/error.h"
#include "reference/ode/exact_solid.h"

namespace lodestone::ode {

void CallersShapes::forget(const SpaceMirror& mirror) {
  for (const std::uint32_t slot : mirror.added()) {
    if (slot >= known_.size()) continue;
    known_[slot] = false;
    shapes_[slot] = {};
  }
}

const Shape* CallersShapes::find(const SpaceMirror& mirror, std::uint32_t slot) {
  const MirroredGeom& geom = mirror.geoms()[slot];
  if (geom.kind != GeomKind::box && geom.kind != GeomKind::convex && geom.kind != GeomKind::trimesh)
    return nullptr;
  if (slot >= known_.size()) known_.resize(mirror.geoms().size()), shapes_.resize(mirror.geoms().size());
  if (!known_[slot]) {
    shapes_[slot] = make(geom.geom);
    known_[slot] = true;
  }
  return shapes_[slot].get();
}

// What ODE takes for a solid and we do not (a box as thin as a sheet) is left to ODE's own colliders.
std::shared_ptr<const Shape> CallersShapes::make(dxGeom* geom) {
  const GeomShape read = read_geom(geom);
  if (read.kind == GeomKind::trimesh) return find_exact_solid("caller's mesh", {read.vertices, read.faces});
  try {
    if (read.kind == GeomKind::box) return box_of(read.sides);
    if (read.faces.empty()) return {};
    return std::make_shared<const Shape>(make_shape("caller's convex", {read.vertices, read.faces}));
  } catch (const InputError&) {
    return {};
  }
}

std::shared_ptr<const Shape> CallersShapes::box_of(const Vec3& sides) {
  std::weak_ptr<const Shape>& known = boxes_[{sides.x(), sides.y(), sides.z()}];
  std::shared_ptr<const Shape> shape = known.lock();
  if (!shape) known = shape = std::make_shared<const Shape>(make_shape("caller's box", make_box(sides)));
  return shape;
}

}  // namespace lodestone::ode
