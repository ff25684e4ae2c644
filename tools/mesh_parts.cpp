#include "tools/mesh_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <vector>

#include "reference/disjoint_sets.h"

namespace lodestone {
namespace {

struct Part {
  std::vector<int> faces, corners;
  Eigen::AlignedBox3d box;
};

std::vector<Part> parts_of(const Mesh& mesh) {
  DisjointSets joined;  // vertices, by faces
  joined.set_all_apart(mesh.vertices.size());
  for (const auto& face : mesh.faces) joined.join(face[0], face[1]), joined.join(face[1], face[2]);
  std::map<int, Part> by_root;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    by_root[joined.root_of(mesh.faces[f][0])].faces.push_back(int(f));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (const auto part = by_root.find(joined.root_of(int(v))); part != by_root.end()) {
      part->second.corners.push_back(int(v));
      part->second.box.extend(mesh.vertices[v]);
    }
  std::vector<Part> parts;
  for (auto& [root, part] : by_root) parts.push_back(std::move(part));
  return parts;
}

// Whether the ray from `point` in `direction` goes through the triangle (Möller and Trumbore, 1997).
bool goes_through(const Vec3& point, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = direction.cross(ac);
  const double det = ab.dot(p);
  if (det == 0.0) return false;
  const Vec3 from_a = point - a, q = from_a.cross(ab);
  const double u = from_a.dot(p) / det, v = direction.dot(q) / det;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / det > 0.0;
}

// By the parity of a ray in a direction that no made shape has.
bool is_inside(const Mesh& mesh, const Part& part, const Vec3& point) {
  if (!part.box.contains(point)) return false;
  static const Vec3 kDirection = Vec3(0.5377, 0.2911, 0.7913).normalized();
  int crossings = 0;
  for (const int f : part.faces) {
    const auto& face = mesh.faces[std::size_t(f)];
    crossings += goes_through(point, kDirection, mesh.vertices[std::size_t(face[0])],
                              mesh.vertices[std::size_t(face[1])], mesh.vertices[std::size_t(face[2])]);
  }
  return crossings % 2 == 1;
}

// Of the corners of `inner` that are looked at, the share in `outer`.
double share_inside(const Mesh& mesh, const Part& inner, const Part& outer) {
  if (!outer.box.intersects(inner.box)) return 0.0;
  const std::size_t stride = std::max<std::size_t>(1, inner.corners.size() / kPartCorners);
  int looked = 0, inside = 0;
  for (std::size_t i = 0; i < inner.corners.size(); i += stride, ++looked)
    inside += is_inside(mesh, outer, mesh.vertices[std::size_t(inner.corners[i])]);
  return double(inside) / looked;
}

}  // namespace

MeshParts find_mesh_parts(const Mesh& mesh) {
  const std::vector<Part> parts = parts_of(mesh);
  MeshParts found{.parts = int(parts.size())};
  for (const Part& part : parts) {
    double most = 0.0;
    for (const Part& other : parts)
      if (&other != &part) most = std::max(most, share_inside(mesh, part, other));
    found.nested += most == 1.0;
    found.overlapping += most > 0.0 && most < 1.0;
  }
  return found;
}

}  // namespace lodestone
