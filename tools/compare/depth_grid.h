// How deep points lie inside a closed mesh: signed distances on a grid, looked up between its nodes (Frisken
// et al., Adaptively sampled distance fields, 2000, without the adaptation).
#pragma once

#include <vector>

#include "reference/mesh/mesh.h"

namespace lodestone {

class DepthGrid {
 public:
  DepthGrid() = default;
  /// `mesh`: closed, outward faces. `cells` along the longest side of its bounding box.
  explicit DepthGrid(const Mesh& mesh, int cells = 48);

  /// m below the surface, negative outside; −∞ off the grid, which reaches a cell beyond the mesh. Off by a
  /// small part of a cell where the surface is smooth.
  double depth(const Vec3& point) const;

 private:
  double& at(int x, int y, int z) { return depths_[std::size_t((z * count_.y() + y) * count_.x() + x)]; }
  double at(int x, int y, int z) const { return depths_[std::size_t((z * count_.y() + y) * count_.x() + x)]; }

  Vec3 low_ = Vec3::Zero();
  double cell_ = 1.0;
  Eigen::Vector3i count_ = Eigen::Vector3i::Zero();  // of nodes
  std::vector<double> depths_;
};

}  // namespace lodestone
