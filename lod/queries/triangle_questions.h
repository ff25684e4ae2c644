// What the triangles of a surface are asked, one after the other: each question says which boxes it need not
// look into (may_meet), is told of triangles (ask), and has an answer at the end. (Ericson, Real-time
// collision detection, 2005: 5.1.5, 5.3.6, 5.5.6; triangles and boxes: Akenine-Möller, Fast 3D triangle-box
// overlap testing, 2001.)
#pragma once

#include <array>
#include <optional>

#include "reference/geometry.h"
#include "reference/mesh/rays.h"

namespace lodestone {

/// Where something that moves along a ray meets a surface.
struct SurfaceHit {
  double distance = 0.0;        ///< m, along the ray
  Vec3 point = Vec3::Zero();    ///< of the surface
  Vec3 normal = Vec3::UnitZ();  ///< outward, unit
};

/// Counter-clockwise seen from outside.
using Triangle = std::array<Vec3, 3>;

/// The first triangle whose outside a ray meets; with a radius, which a sphere meets that moves along the
/// ray: at once, with the nearest point, where it touches one already. `direction` of unit length.
class FirstMet {
 public:
  FirstMet(const Vec3& from, const Vec3& direction, double length, double radius = 0.0)
      : from_(from), direction_(direction), reach_(length), radius_(radius) {}
  bool may_meet(const Eigen::AlignedBox3d& box) const {
    return enters_box(box, radius_, from_, direction_, reach_);
  }
  void ask(const Triangle& triangle);
  const std::optional<SurfaceHit>& hit() const { return hit_; }

 private:
  void sweep(const Triangle& triangle);

  Vec3 from_, direction_;
  double reach_ = 0.0, radius_ = 0.0;  // m
  std::optional<SurfaceHit> hit_;
};

/// The nearest point within `reach` m, from either side; the answer's `distance` is that from `point`.
class NearestPoint {
 public:
  NearestPoint(const Vec3& point, double reach) : point_(point), square_(reach * reach) {}
  bool may_meet(const Eigen::AlignedBox3d& box) const {
    return box.squaredExteriorDistance(point_) <= square_;
  }
  void ask(const Triangle& triangle);
  const std::optional<SurfaceHit>& hit() const { return hit_; }

 private:
  Vec3 point_;
  double square_ = 0.0;  // m²
  std::optional<SurfaceHit> hit_;
};

/// Whether any triangle meets a box of these half sides, whose own axes are the columns of `axes`.
class MeetsBox {
 public:
  MeetsBox(const Vec3& center, const Mat3& axes, const Vec3& half)
      : center_(center), axes_(axes), half_(half) {
    const Vec3 reach = axes.cwiseAbs() * half;
    around_ = {center - reach, center + reach};
  }
  bool may_meet(const Eigen::AlignedBox3d& box) const { return !met_ && around_.intersects(box); }
  void ask(const Triangle& triangle);
  /// Of the triangle that was found, the point nearest to the box's middle.
  const std::optional<Vec3>& met() const { return met_; }

 private:
  Vec3 center_;
  Mat3 axes_;
  Vec3 half_;
  Eigen::AlignedBox3d around_;
  std::optional<Vec3> met_;
};

/// How many triangles a ray crosses, from either side.
class Crossings {
 public:
  Crossings(const Vec3& from, const Vec3& direction, double length)
      : from_(from), direction_(direction), length_(length) {}
  bool may_meet(const Eigen::AlignedBox3d& box) const {
    return enters_box(box, 0.0, from_, direction_, length_);
  }
  void ask(const Triangle& triangle);
  int number() const { return crossings_; }

 private:
  Vec3 from_, direction_;
  double length_ = 0.0;  // m
  int crossings_ = 0;
};

/// m: of a ray into a sphere about `center`, from outside; a start inside meets it at 0. None where it
/// misses.
std::optional<double> meet_sphere(const Vec3& from, const Vec3& direction, double length, const Vec3& center,
                                  double radius);

}  // namespace lodestone
