// The faces of the solids near a body, and where one solid covers a face of another, so that nothing can meet
// that there.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lod/ground/ground.h"

namespace lodestone {

/// A face of a solid, in the world.
struct Face {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0.0;  ///< m
  double height_of(const Vec3& point) const { return normal.dot(point) - offset; }
};

/// Of one solid.
struct SolidFaces {
  std::vector<Face> faces, walls;  ///< walls: of a triangle, the planes across its edges
  std::array<bool, 3> ends{};      ///< of each wall: a triangle's surface goes on beyond it otherwise
  double depth = 1e300;            ///< m: so far below its face a triangle is solid

  void find(const PlacedSolid& solid);
  /// What bounds each face: of a convex solid all of them, that face, too.
  std::span<const Face> bounds() const { return walls.empty() ? faces : walls; }
  /// Along the face's normal, but for `rounding` (m).
  bool are_under(const Vec3& point, const Face& face, double rounding) const;
};

/// Of all solids near a body; found as they are asked for.
class NearFaces {
 public:
  /// `center`, `radius`, m: of the body. `near` stays as it is until the next call.
  void take(std::span<const PlacedSolid> near, const Vec3& center, double radius);

  const SolidFaces& of(const PlacedSolid& solid);
  std::span<const PlacedSolid> solids() const { return near_; }

  /// Whether another solid covers the face of `solid` at the foot of `place` (world), but for a step of less
  /// than a hundredth of the radius.
  bool is_covered(const PlacedSolid& solid, const Face& face, const Vec3& place);
  /// Along which `solid` is met at `place`, where its own shape says `normal`: that, or if what is beside its
  /// edge there is covered one of its faces; none if that is covered.
  std::optional<Vec3> find_uncovered(const PlacedSolid& solid, const Vec3& place, const Vec3& normal);

 private:
  bool covers(const PlacedSolid& other, const SolidFaces& own, const Face& face, const Vec3& foot);

  std::span<const PlacedSolid> near_;
  std::vector<SolidFaces> faces_;
  std::vector<bool> known_;
  Vec3 center_ = Vec3::Zero();
  double radius_ = 0.0;  // m
};

}  // namespace lodestone
