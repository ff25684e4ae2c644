#include "lod/ground/ground_solids.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "lod/ground/box_tree.h"
#include "reference/hull/convex_pieces.h"
#include "reference/mesh/mesh_edges.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr double kSurfaceDepth = 0.02;  // of a surface's triangles, over the diagonal of its bounding box
constexpr double kRidgeSine = 0.05;     // an edge whose faces fall away by more than this (3°) stands out

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

// Whether the surface falls away at an edge, or ends there.
bool is_ridge(const Mesh& mesh, std::span<const EdgeUse> uses) {
  if (uses.size() != 2) return true;
  const Vec3 normal = normal_of(mesh, mesh.faces[std::size_t(uses[0].face)]).normalized();
  for (const int v : mesh.faces[std::size_t(uses[1].face)]) {
    if (v == uses[1].low || v == uses[1].high) continue;
    const Vec3 away = mesh.vertices[v] - mesh.vertices[uses[1].low];
    return away.dot(normal) < -kRidgeSine * away.norm();
  }
  return true;
}

// The place in `face` of the edge that it uses.
std::size_t edge_of(const std::array<int, 3>& face, const EdgeUse& use) {
  const int from = use.forward ? use.low : use.high;
  return std::size_t(std::ranges::find(face, from) - face.begin());
}

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

// Only what contacts need, and a support map of few cells: there may be many thousands. `hull` is about the
// `middle`.
std::shared_ptr<const Shape> make_solid_shape(Hull hull, const Vec3& middle) {
  constexpr int kCellsAlong = 4;
  Shape shape;
  shape.name = "ground";
  shape.hull = std::move(hull);
  shape.support_map = SupportMap(shape.hull, shape.hull.vertices.size() <= 6 ? 1 : kCellsAlong);
  shape.center_of_mass_in_mesh = middle;
  shape.convex = true;
  for (const Vec3& p : shape.hull.vertices) shape.radius = std::max(shape.radius, p.norm());
  return std::make_shared<const Shape>(std::move(shape));
}

}  // namespace

void GroundSolids::add(const std::shared_ptr<const Shape>& shape, const Vec3& center) {
  solids_.push_back({shape, center, faces_of(shape->hull), {}});
  Box box;
  for (const Vec3& v : shape->hull.vertices) box.extend(center + v);
  bounds_.push_back(box);
  all_bounds_.extend(box);
  tree_.reset();
}

void GroundSolids::add_hull(std::span<const Vec3> points) {
  const Vec3 middle = bounds_of(points).center();
  std::vector<Vec3> around;
  for (const Vec3& p : points) around.push_back(p - middle);
  add(make_solid_shape(make_hull(around), middle), middle);
}

void GroundSolids::add_sphere(double radius) {
  auto shape = std::make_shared<Shape>();
  shape->name = "ground";
  shape->sphere_radius = shape->radius = radius;
  shape->convex = true;
  solids_.push_back({std::move(shape), Vec3::Zero(), {}, {}});
  bounds_.emplace_back(Vec3::Constant(-radius), Vec3::Constant(radius));
  all_bounds_.extend(bounds_.back());
  tree_.reset();
}

void GroundSolids::add_mesh(const Mesh& mesh) {
  const double size = bounds_of(mesh.vertices).diagonal().norm();
  constexpr std::size_t kFewFaces = 2000;  // among which convexity is tested face by face
  if (!is_closed(mesh) || mesh.faces.size() > kFewFaces) return add_surface(mesh);
  const Hull hull = make_hull(mesh.vertices);
  if (is_convex(mesh, 1e-9 * size)) return add_hull(hull.vertices);
  const std::vector<Hull> pieces = find_convex_pieces(mesh, hull);
  if (pieces.empty()) return add_surface(mesh);
  for (const Hull& piece : pieces) add_hull(piece.vertices);
}

void GroundSolids::add_surface(const Mesh& mesh) {
  const double depth = kSurfaceDepth * bounds_of(mesh.vertices).diagonal().norm();
  std::vector<std::array<bool, 3>> ridge(mesh.faces.size(), {true, true, true});
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) {
    for (const EdgeUse& use : uses)
      ridge[std::size_t(use.face)][edge_of(mesh.faces[std::size_t(use.face)], use)] = is_ridge(mesh, uses);
  });
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& f = mesh.faces[i];
    const std::array<Vec3, 3> corner{mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
    const Vec3 across = normal_of(mesh, f);
    const double longest = std::max(
        {(corner[1] - corner[0]).norm(), (corner[2] - corner[1]).norm(), (corner[0] - corner[2]).norm()});
    if (!(across.norm() > 1e-9 * longest * longest)) continue;
    const Vec3 normal = across.normalized(), below = -depth * normal;
    Box box = bounds_of(corner);
    for (const Vec3& c : corner) box.extend(c + below);
    const Vec3 middle = box.center();
    add(make_solid_shape(make_prism_hull({corner[0] - middle, corner[1] - middle, corner[2] - middle}, below),
                         middle),
        middle);
    solids_.back().surface = SurfaceTriangle{normal, corner, ridge[i], depth};
  }
}

struct GroundSolids::Tree : BoxTree {
  using BoxTree::BoxTree;
};

void GroundSolids::prepare() {
  if (tree_ || solids_.size() < 2) return;
  std::vector<int> indices(solids_.size());
  std::iota(indices.begin(), indices.end(), 0);
  tree_ = std::make_shared<const Tree>(indices.begin(), indices.end(), bounds_.begin(), bounds_.end());
}

void GroundSolids::find_near(const Vec3& center, double reach, std::vector<int>& found) const {
  const auto add = [&](int i) {
    if (bounds_[std::size_t(i)].squaredExteriorDistance(center) <= reach * reach) found.push_back(i);
  };
  if (tree_)
    tree_->visit_near(center, reach, add);
  else if (solids_.size() == 1)
    add(0);
}

}  // namespace lodestone
