// The surfaces that queries meet, at the places where they stand: a mesh, a sphere, what is made of solids.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "lod/ground/ground_solids.h"
#include "lod/queries/triangle_tree.h"
#include "reference/shape.h"

namespace lodestone {

/// Trees of shapes, each made when it is first asked for, and kept while others have the shape. From any
/// thread.
class ShapeTrees {
 public:
  const TriangleTree& of(const std::shared_ptr<const Shape>& shape);

 private:
  struct Entry {
    std::shared_ptr<const Shape> shape;  // its address stays its own
    std::unique_ptr<const TriangleTree> tree;
  };
  void drop_unused();

  std::mutex access_;
  std::unordered_map<const Shape*, Entry> trees_;
  std::size_t most_ = 64;  // until those that are no longer used are looked for
};

/// A ray of unit direction and the radius of the sphere that moves along it, 0: none.
struct Sweep {
  Vec3 from, direction;
  double length = 0.0, radius = 0.0;
};
/// A sphere, or a box of these half sides along the columns of `axes`; about `center`, within `reach` m.
struct Volume {
  Vec3 center;
  double reach = 0.0;
  bool is_box = false;
  Mat3 axes = Mat3::Identity();
  Vec3 half = Vec3::Zero();
};

/// A mesh at a place, or what is a sphere.
struct PosedSurface {
  const TriangleTree* tree = nullptr;  ///< null: a sphere
  double sphere_radius = 0.0;
  Vec3 position;
  Quat orientation;
};
std::optional<SurfaceHit> meet(const PosedSurface& surface, const Sweep& sweep);
std::optional<SurfaceHit> overlap(const PosedSurface& surface, const Volume& volume);

/// What is made of solids, at a place. One of triangles is met by these, from outside; what is below them, as
/// far as they are solid, is within it.
class SolidQueries {
 public:
  // From any thread.
  std::optional<SurfaceHit> meet(const GroundSolids& solids, const Vec3& position, const Quat& orientation,
                                 const Sweep& sweep);
  std::optional<SurfaceHit> overlap(const GroundSolids& solids, const Vec3& position, const Quat& orientation,
                                    const Volume& volume);

 private:
  PosedSurface surface_of(const GroundSolid& solid);
  bool is_within(const SurfaceSolids& surface, const Vec3& point);
  std::optional<SurfaceHit> meet(const SurfaceSolids& surface, const Sweep& sweep);
  std::optional<SurfaceHit> overlap(const SurfaceSolids& surface, const Volume& volume);

  ShapeTrees trees_;
};

}  // namespace lodestone
