#include "lod/queries/triangle_tree.h"

namespace lodestone {

TriangleTree::TriangleTree(const Mesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& face : mesh.faces) {
    Eigen::AlignedBox3d& box = boxes.emplace_back();
    for (const int corner : face) box.extend(mesh.vertices[std::size_t(corner)]);
    bounds_.extend(box);
  }
  tree_ = BoxHierarchy(boxes);
  for (std::size_t place = 0; place < boxes.size(); ++place) {
    const auto& f = mesh.faces[std::size_t(tree_.number_at(std::int32_t(place)))];
    triangles_.push_back({mesh.vertices[std::size_t(f[0])], mesh.vertices[std::size_t(f[1])],
                          mesh.vertices[std::size_t(f[2])]});
  }
}

// An odd number of crossings, along a line that is unlikely to graze an edge.
bool TriangleTree::contains(const Vec3& point) const {
  if (!bounds_.contains(point)) return false;
  const Vec3 direction = Vec3(0.5773, 0.2113, 0.7887).normalized();
  return ask(Crossings(point, direction, 2.0 * bounds_.diagonal().norm())).number() % 2 == 1;
}

}  // namespace lodestone
