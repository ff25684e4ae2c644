#include "reference/ode/callers_shapes_ode.h"

#include "reference/error.h"

namespace lodestone::ode {

void CallersShapes::forget(const SpaceMirror& mirror) {
  for (const std::uint32_t slot : mirror.added()) {
    if (slot >= known_.size()) continue;
    known_[slot] = Known::no;
    shapes_[slot] = {};
  }
}

const CallersShape* CallersShapes::find(const SpaceMirror& mirror, std::uint32_t slot) {
  const MirroredGeom& geom = mirror.geoms()[slot];
  if (geom.kind != GeomKind::box && geom.kind != GeomKind::convex) return nullptr;
  if (slot >= known_.size()) known_.resize(mirror.geoms().size()), shapes_.resize(mirror.geoms().size());
  if (known_[slot] == Known::no) {
    shapes_[slot] = make(geom.geom);
    known_[slot] = shapes_[slot].shape ? Known::yes : Known::none;
  }
  return known_[slot] == Known::yes ? &shapes_[slot] : nullptr;
}

// What ODE takes for a solid and we do not (a box as thin as a sheet) is left to ODE's own colliders.
CallersShape CallersShapes::make(dxGeom* geom) {
  try {
    const GeomShape read = read_geom(geom);
    if (read.kind == GeomKind::box) return {box_of(read.sides)};
    if (read.faces.empty()) return {};
    const auto shape =
        std::make_shared<const Shape>(make_shape("caller's convex", {read.vertices, read.faces}));
    return {shape, shape->center_of_mass_in_mesh};
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
