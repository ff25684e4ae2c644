// How deep the bodies of a pile overlap, whatever method moved them: hulls of convex bodies; exact pieces of
// concave ones that have them (Shape::pieces); otherwise the vertices of each mesh in the other.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lod/ground/ground.h"
#include "reference/hull/hull_overlap.h"
#include "reference/shape.h"
#include "tools/compare/depth_grid.h"

namespace lodestone {

class PileOverlap {
 public:
  /// Of bodies of `shape`, which must outlive it, among `planes`.
  PileOverlap(const Shape& shape, std::vector<HalfSpace> planes);

  /// m; 0 or less where the two are apart.
  double depth_of_pair(const RigidState& first, const RigidState& second) const;
  /// m; negative where the body is clear of every plane.
  double depth_in_planes(const RigidState& state) const;

  /// Of any pair, or of any body in a plane, m; 0 where nothing overlaps.
  double deepest(std::span<const RigidState> states) const;
  /// Of those pairs that overlap, m; 0 where none does.
  double median_depth(std::span<const RigidState> states) const;
  /// Bodies that would touch nothing though moved down by `drop` (m).
  int count_hovering(std::span<const RigidState> states, std::span<const char> at_rest, double drop) const;
  /// Bodies whose centre is behind a plane.
  int count_escaped(std::span<const RigidState> states) const;

 private:
  double depth_of_vertices(const RigidState& of, const RigidState& in) const;

  const Shape& shape_;
  std::vector<HalfSpace> planes_;
  DepthGrid grid_;  // of a concave shape without pieces
};

}  // namespace lodestone
