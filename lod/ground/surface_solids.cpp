#include "lod/ground/surface_solids.h"

#include <algorithm>
#include <span>

#include "reference/mesh/mesh_edges.h"

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

constexpr double kDepth = 0.02;      // of the solids, over the diagonal of the surface's bounding box
constexpr double kRidgeSine = 0.05;  // an edge whose faces fall away by more than this (3°) stands out

// Of the face's area, twice.
Vec3 area_vector(const Mesh& mesh, const std::array<int, 3>& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
}

bool has_area(const Mesh& mesh, const std::array<int, 3>& f) {
  const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return area_vector(mesh, f).norm() > 1e-9 * longest * longest;
}

// Whether the surface falls away at an edge, or ends there.
bool is_ridge(const Mesh& mesh, std::span<const EdgeUse> uses) {
  if (uses.size() != 2) return true;
  const Vec3 normal = area_vector(mesh, mesh.faces[std::size_t(uses[0].face)]).normalized();
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

// Of its corners, and as far below them as it is solid.
Box bounds_of(const std::array<Vec3, 3>& corner, const Vec3& below) {
  Box box;
  for (const Vec3& c : corner) box.extend(c), box.extend(c + below);
  return box;
}

}  // namespace

SurfaceSolids::SurfaceSolids(const Mesh& mesh) : vertices_(mesh.vertices) {
  Box box;
  for (const Vec3& v : vertices_) box.extend(v);
  depth_ = kDepth * box.diagonal().norm();
  std::vector<std::array<bool, 3>> ridge(mesh.faces.size(), {true, true, true});
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) {
    for (const EdgeUse& use : uses)
      ridge[std::size_t(use.face)][edge_of(mesh.faces[std::size_t(use.face)], use)] = is_ridge(mesh, uses);
  });
  triangles_.reserve(mesh.faces.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    if (has_area(mesh, mesh.faces[i])) triangles_.push_back({mesh.faces[i], ridge[i]});
  solids_ = std::make_unique<std::atomic<const GroundSolid*>[]>(triangles_.size());
}

SurfaceSolids::~SurfaceSolids() {
  for (std::size_t i = 0; i < size(); ++i) delete solids_[i].load();
}

std::array<Vec3, 3> SurfaceSolids::corners_of(const Triangle& triangle) const {
  const auto at = [&](int i) { return vertices_[std::size_t(triangle.corner[std::size_t(i)])]; };
  return {at(0), at(1), at(2)};
}

Vec3 SurfaceSolids::normal_of(const Triangle& triangle) const {
  const std::array<Vec3, 3> corner = corners_of(triangle);
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
}

Box SurfaceSolids::bounds(std::size_t i) const {
  return bounds_of(corners_of(triangles_[i]), -depth_ * normal_of(triangles_[i]));
}

GroundSolid SurfaceSolids::make(const Triangle& triangle) const {
  const std::array<Vec3, 3> corner = corners_of(triangle);
  const Vec3 normal = normal_of(triangle), below = -depth_ * normal,
             middle = bounds_of(corner, below).center();
  GroundSolid solid = make_ground_solid(
      make_prism_hull({corner[0] - middle, corner[1] - middle, corner[2] - middle}, below), middle);
  solid.surface = SurfaceTriangle{normal, corner, triangle.ridge, depth_};
  return solid;
}

const GroundSolid& SurfaceSolids::operator[](std::size_t i) const {
  std::atomic<const GroundSolid*>& place = solids_[i];
  if (const GroundSolid* made = place.load(std::memory_order_acquire)) return *made;
  auto fresh = std::make_unique<const GroundSolid>(make(triangles_[i]));
  const GroundSolid* there = nullptr;  // of two threads one comes second, and takes the other's
  if (place.compare_exchange_strong(there, fresh.get(), std::memory_order_acq_rel)) return *fresh.release();
  return *there;
}

std::size_t SurfaceSolids::made() const {
  return std::size_t(
      std::count_if(solids_.get(), solids_.get() + size(), [](const auto& s) { return s.load(); }));
}

}  // namespace lodestone
