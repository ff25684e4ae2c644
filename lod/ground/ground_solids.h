// What a part of the ground is made of: convex solids in the part's own frame, found by a tree of their
// bounding boxes. A convex mesh is one solid, a concave one of few faces as many as its convex pieces, and of
// any other mesh each triangle is one, solid a little way below its surface.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

/// Of a surface: what is met across an edge that is no ridge is met along the normal, or bodies would stumble
/// over the seams of a flat floor.
struct SurfaceTriangle {
  Vec3 normal = Vec3::UnitZ();
  std::array<Vec3, 3> corner;  ///< m, in the part's frame
  std::array<bool, 3>
      ridge{};         ///< whether the edge from corner i to the next stands out, or is the surface's border
  double depth = 0.0;  ///< m: so far below its surface it is solid
};

/// All of the solid has normal·x ≤ offset, in its shape's frame.
struct SolidFace {
  Vec3 normal = Vec3::UnitZ();  ///< unit, outward
  double offset = 0.0;          ///< m
};

/// Its axes are those of its part.
struct GroundSolid {
  std::shared_ptr<const Shape> shape;
  Vec3 center = Vec3::Zero();    ///< m, of the shape's frame in the part's
  std::vector<SolidFace> faces;  ///< each normal once
  std::optional<SurfaceTriangle> surface;
};

class GroundSolids {
 public:
  /// The hull of `points` (in the part's frame). Throws InputError where they lie in a plane.
  void add_hull(std::span<const Vec3> points);
  void add_sphere(double radius);  ///< m, about the part's own origin
  /// Faces counter-clockwise from outside. Faces without area are left out.
  void add_mesh(const Mesh& mesh);
  /// To be called after solids were added, before they are looked for.
  void prepare();

  std::size_t size() const { return solids_.size(); }
  const GroundSolid& operator[](int i) const { return solids_[std::size_t(i)]; }
  const Eigen::AlignedBox3d& bounds() const { return all_bounds_; }
  /// Appends the indices of the solids whose bounding boxes come within `reach` of `center`, both in the
  /// part's frame.
  void find_near(const Vec3& center, double reach, std::vector<int>& found) const;

 private:
  void add(const std::shared_ptr<const Shape>& shape, const Vec3& center);
  void add_surface(const Mesh& mesh);

  std::vector<GroundSolid> solids_;
  std::vector<Eigen::AlignedBox3d> bounds_;
  Eigen::AlignedBox3d all_bounds_;
  struct Tree;
  std::shared_ptr<const Tree> tree_;  // shared by copies; null for one solid alone
};

}  // namespace lodestone
