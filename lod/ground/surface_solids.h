// A surface of triangles as ground: each is a solid, which is made when something first comes near it, as a
// solid takes a hundred times the memory of its triangle and most of a landscape lies idle.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "lod/ground/ground_solid.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

class SurfaceSolids {
 public:
  /// Faces counter-clockwise from outside, vertices in the part's frame, m. Faces without area are left out.
  explicit SurfaceSolids(const Mesh& mesh);
  ~SurfaceSolids();
  SurfaceSolids(const SurfaceSolids&) = delete;
  SurfaceSolids& operator=(const SurfaceSolids&) = delete;

  std::size_t size() const { return triangles_.size(); }
  Eigen::AlignedBox3d bounds(std::size_t i) const;
  /// For any thread at any time; stays where it is.
  const GroundSolid& operator[](std::size_t i) const;
  /// How many of them something has come near.
  std::size_t made() const;

 private:
  struct Triangle {
    std::array<int, 3> corner;  // in vertices_
    std::array<bool, 3> ridge;
  };

  std::array<Vec3, 3> corners_of(const Triangle& triangle) const;
  Vec3 normal_of(const Triangle& triangle) const;
  GroundSolid make(const Triangle& triangle) const;

  std::vector<Vec3> vertices_;  // m
  std::vector<Triangle> triangles_;
  double depth_ = 0.0;                                         // m: so far below the surface each is solid
  std::unique_ptr<std::atomic<const GroundSolid*>[]> solids_;  // of each triangle; null: not made yet
};

}  // namespace lodestone
