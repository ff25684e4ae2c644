#include "lod/ground/ground_solids.h"

#include <optional>
#include <span>

#include "reference/error.h"
#include "reference/hull/convex_pieces.h"
#include "reference/mesh/mesh_edges.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

Box bounds_of(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

Vec3 normal_of(const Mesh& mesh, const std::array<int, 3>& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
}

bool is_closed(const Mesh& mesh) {
  bool closed = true;
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) { closed = closed && uses.size() == 2; });
  return closed;
}

// No vertex stands above a face.
bool is_convex(const Mesh& mesh, double tolerance) {
  for (const auto& f : mesh.faces) {
    const Vec3 normal = normal_of(mesh, f).normalized();
    for (const Vec3& v : mesh.vertices)
      if ((v - mesh.vertices[f[0]]).dot(normal) > tolerance) return false;
  }
  return true;
}

// None of a sheet that is closed, seen from both sides.
std::optional<Hull> hull_unless_flat(std::span<const Vec3> points) {
  try {
    return make_hull(points);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

void GroundSolids::add(GroundSolid solid, const Box& bounds) {
  solids_.push_back(std::move(solid));
  bounds_.push_back(bounds);
  all_bounds_.extend(bounds);
  tree_.reset();
}

void GroundSolids::add_hull(std::span<const Vec3> points) {
  const Vec3 middle = bounds_of(points).center();
  std::vector<Vec3> around;
  for (const Vec3& p : points) around.push_back(p - middle);
  Hull hull = make_hull(around);
  Box box;
  for (const Vec3& v : hull.vertices) box.extend(middle + v);
  add(make_ground_solid(std::move(hull), middle), box);
}

void GroundSolids::add_sphere(double radius) {
  add(make_ground_ball(radius), Box(Vec3::Constant(-radius), Vec3::Constant(radius)));
}

void GroundSolids::add_mesh(const Mesh& mesh) {
  const double size = bounds_of(mesh.vertices).diagonal().norm();
  constexpr std::size_t kFewFaces = 2000;  // among which convexity is tested face by face
  if (!is_closed(mesh) || mesh.faces.size() > kFewFaces) return add_surface(mesh);
  const std::optional<Hull> hull = hull_unless_flat(mesh.vertices);
  if (!hull) return add_surface(mesh);
  if (is_convex(mesh, 1e-9 * size)) return add_hull(hull->vertices);
  const std::vector<Hull> pieces = find_convex_pieces(mesh, *hull);
  if (pieces.empty()) return add_surface(mesh);
  for (const Hull& piece : pieces) add_hull(piece.vertices);
}

void GroundSolids::add_surface(const Mesh& mesh) {
  surface_ = std::make_shared<const SurfaceSolids>(mesh);
  all_bounds_.extend(surface_->bounds());
}

void GroundSolids::prepare() {
  if (!tree_) tree_ = std::make_shared<const BoxHierarchy>(bounds_);
}

void GroundSolids::find_bodies_near(const Vec3& center, double reach, std::vector<int>& found) const {
  const auto add = [&](int i) {
    if (bounds_[std::size_t(i)].squaredExteriorDistance(center) <= reach * reach) found.push_back(i);
  };
  if (tree_) tree_->visit_near(center, reach, add);
}

void GroundSolids::find_near(const Vec3& center, double reach, std::vector<int>& found) const {
  find_bodies_near(center, reach, found);
  if (surface_) surface_->find_near(center, reach, int(solids_.size()), found);
}

}  // namespace lodestone
