// Prisms as shapes.
#pragma once

#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "reference/shape.h"

namespace lodestone::testing {

inline std::shared_ptr<const Shape> make_convex(const char* name, std::span<const Vec3> corners) {
  const Hull hull = make_hull(corners);
  Mesh mesh;
  mesh.vertices = hull.vertices;
  mesh.faces = hull.faces;
  return std::make_shared<const Shape>(make_shape(name, mesh));
}

/// About z, its corners on a circle of `radius` m.
inline std::shared_ptr<const Shape> make_prism(int sides, double radius, double thickness) {
  std::vector<Vec3> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    for (const double z : {-0.5, 0.5})
      corners.push_back({radius * std::cos(angle), radius * std::sin(angle), z * thickness});
  }
  return make_convex("prism", corners);
}

}  // namespace lodestone::testing
