#include "lod/ground/ground_solid.h"

#include <algorithm>

namespace lodestone {
namespace {

std::vector<SolidFace> faces_of(const Hull& hull) {
  std::vector<SolidFace> faces;
  for (int face = 0; face < int(hull.faces.size()); ++face) {
    const Vec3 normal = hull.face_normals[std::size_t(face)];
    const auto same = [&](const SolidFace& f) { return (f.normal - normal).squaredNorm() < 1e-12; };
    if (std::ranges::none_of(faces, same))
      faces.push_back({normal, hull.vertices[std::size_t(find_support(hull, normal))].dot(normal)});
  }
  return faces;
}

// Only what contacts need, and a support map of few cells: there may be many thousands.
std::shared_ptr<const Shape> make_shape_of_hull(Hull hull, const Vec3& center) {
  constexpr int kCellsAlong = 4;
  Shape shape;
  shape.name = "ground";
  shape.hull = std::move(hull);
  shape.support_map = SupportMap(shape.hull, shape.hull.vertices.size() <= 6 ? 1 : kCellsAlong);
  shape.center_of_mass_in_mesh = center;
  shape.convex = true;
  for (const Vec3& p : shape.hull.vertices) shape.radius = std::max(shape.radius, p.norm());
  return std::make_shared<const Shape>(std::move(shape));
}

}  // namespace

GroundSolid make_ground_solid(Hull hull, const Vec3& center) {
  std::vector<SolidFace> faces = faces_of(hull);
  return {make_shape_of_hull(std::move(hull), center), center, std::move(faces), {}};
}

GroundSolid make_ground_ball(double radius) {
  Shape shape;
  shape.name = "ground";
  shape.sphere_radius = shape.radius = radius;
  shape.convex = true;
  return {std::make_shared<const Shape>(std::move(shape)), Vec3::Zero(), {}, {}};
}

}  // namespace lodestone
