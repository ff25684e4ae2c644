// What a part of the ground is made of: convex solids in the part's own frame, found by a tree of their
// bounding boxes. A convex mesh is one solid, a concave one of few faces as many as its convex pieces, and of
// any other mesh each triangle is one, solid a little way below its surface.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lod/ground/surface_solids.h"
#include "reference/mesh/box_hierarchy.h"

namespace lodestone {

class GroundSolids {
 public:
  /// The hull of `points` (in the part's frame). Throws InputError where they lie in a plane.
  void add_hull(std::span<const Vec3> points);
  void add_sphere(double radius);  ///< m, about the part's own origin
  /// Faces counter-clockwise from outside. Faces without area are left out. Nothing is added after one whose
  /// triangles are solids.
  void add_mesh(const Mesh& mesh);
  /// To be called after solids were added, before they are looked for.
  void prepare();

  std::size_t size() const { return solids_.size() + (surface_ ? surface_->size() : 0); }
  /// For any thread at any time; stays where it is until something is added.
  const GroundSolid& operator[](int i) const {
    const auto place = std::size_t(i);
    return place < solids_.size() ? solids_[place] : (*surface_)[place - solids_.size()];
  }
  const Eigen::AlignedBox3d& bounds() const { return all_bounds_; }
  /// Appends the indices of the solids that may come within `reach` of `center`, both in the part's frame: by
  /// their bounding boxes, of a surface as DeepTriangles finds them.
  void find_near(const Vec3& center, double reach, std::vector<int>& found) const;
  /// Those that are not triangles of a surface, found by their bounding boxes.
  std::span<const GroundSolid> bodies() const { return solids_; }
  void find_bodies_near(const Vec3& center, double reach, std::vector<int>& found) const;
  /// The indices of those whose boxes come within `margin` of a ray before `length`, in the part's frame, m.
  template <class Visit>
  void visit_bodies_along(const Vec3& from, const Vec3& direction, const double& length, double margin,
                          const Visit& visit) const {
    if (tree_) tree_->visit_along(from, direction, length, margin, visit);
  }
  /// Null: it has none.
  const SurfaceSolids* surface() const { return surface_.get(); }

 private:
  void add(GroundSolid solid, const Eigen::AlignedBox3d& bounds);
  void add_surface(const Mesh& mesh);

  std::vector<GroundSolid> solids_;
  std::vector<Eigen::AlignedBox3d> bounds_;       // of these
  std::shared_ptr<const SurfaceSolids> surface_;  // behind those, shared by copies
  Eigen::AlignedBox3d all_bounds_;
  std::shared_ptr<const BoxHierarchy> tree_;  // of these, shared by copies; null: not made yet
};

}  // namespace lodestone
