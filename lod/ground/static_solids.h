// Static boxes and meshes as statistical bodies meet them: convex solids, found by a tree of their bounding boxes. A convex mesh is one solid, a concave
// one of few faces as many as its convex pieces, and of any other mesh each triangle is one, solid a little way below its surface.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "reference/material.h"
#include "reference/shape.h"

namespace lodestone {

/// Of a surface: what is met across an edge that is no ridge is met along the normal, or bodies would stumble over the seams of a flat floor.
struct SurfaceTriangle {
  Vec3 normal = Vec3::UnitZ();
  std::array<Vec3, 3> corner;                 ///< m, world
  std::array<bool, 3> ridge{};                ///< whether the edge from corner i to the next stands out, or is the surface's border
};

struct StaticSolid {
  std::shared_ptr<const Shape> shape;
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  MaterialId material = 0;
  std::vector<Vec3> face_normals;             ///< outward, the solid's axes, each once
  std::optional<SurfaceTriangle> surface;
};

class StaticSolids {
 public:
  void add_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material);
  /// Vertices in the world frame, faces counter-clockwise from outside. Faces without area are left out.
  void add_mesh(const Mesh& mesh, MaterialId material);
  /// To be called after solids were added, before they are looked for.
  void prepare();

  bool empty() const { return solids_.empty(); }
  std::size_t size() const { return solids_.size(); }
  const StaticSolid& operator[](int i) const { return solids_[std::size_t(i)]; }
  /// Appends the indices of the solids whose bounding boxes come within `reach` of `center`.
  void find_near(const Vec3& center, double reach, std::vector<int>& found) const;

 private:
  void add(const std::shared_ptr<const Shape>& shape, const Vec3& position, const Quat& orientation, MaterialId material);
  void add_surface(const Mesh& mesh, MaterialId material);

  std::vector<StaticSolid> solids_;
  std::vector<Eigen::AlignedBox3d> bounds_;
  struct Tree;
  std::shared_ptr<const Tree> tree_;  // shared by copies; null where it must be built anew
};

}  // namespace lodestone
