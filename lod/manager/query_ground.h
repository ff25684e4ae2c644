// The ground as queries meet it: planes, and solids by their surfaces.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "lod/callers/callers_ground.h"
#include "lod/queries.h"
#include "lod/queries/triangle_tree.h"

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

class QueryGround {
 public:
  QueryGround(const Ground& ground, const CallersGround& callers) : ground_(ground), callers_(callers) {}

  using Found = std::function<void(const QueryHit&)>;
  // Each piece at most once, at its first point; the ray of a sweep may become shorter meanwhile. From any
  // thread.
  void meet(const Sweep& sweep, const Found& found);
  void overlap(const Volume& volume, const Found& found);
  /// While it lasts no question makes solids of the ground.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(access_); }

 private:
  ContactSide side_of(GroundId id, MaterialId material) const;
  void meet_parts(std::span<const PlacedSolid> solids,
                  const std::function<std::optional<SurfaceHit>(const PosedSurface&)>& meet_one,
                  const Found& found);
  std::vector<PlacedSolid> find_along(const Sweep& sweep, std::vector<const GroundPart*>& probed);
  std::vector<PlacedSolid> find_near(const Vec3& center, double reach,
                                     std::vector<const GroundPart*>& probed);
  PosedSurface surface_of(const PlacedSolid& solid);

  const Ground& ground_;
  const CallersGround& callers_;
  ShapeTrees trees_;
  std::mutex access_;  // to the ground, which makes solids as it is asked for them
};

}  // namespace lodestone
