// The triangles of a mesh in a tree of boxes, to be asked what a ray, a moving sphere or a box meets. Made
// once for each shape. (Ericson, Real-time collision detection, 2005: 5.1.5, 5.3.6, 5.5.6; triangles and
// boxes: Akenine-Möller, Fast 3D triangle-box overlap testing, 2001.)
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "reference/mesh/mesh.h"

namespace lodestone {

/// Where something that moves along a ray meets a surface.
struct SurfaceHit {
  double distance = 0.0;        ///< m, along the ray
  Vec3 point = Vec3::Zero();    ///< of the surface
  Vec3 normal = Vec3::UnitZ();  ///< outward, unit
};

class TriangleTree {
 public:
  /// Faces counter-clockwise seen from outside.
  explicit TriangleTree(const Mesh& mesh);

  /// The first triangle whose outside a ray meets. `direction` of unit length.
  std::optional<SurfaceHit> cast(const Vec3& from, const Vec3& direction, double length) const;
  /// The first that a sphere meets which moves along a ray; at once, with the nearest point, where it touches
  /// one already.
  std::optional<SurfaceHit> sweep(const Vec3& from, const Vec3& direction, double length,
                                  double radius) const;
  /// The nearest point within `reach`; `distance` is that from `point`.
  std::optional<SurfaceHit> find_nearest(const Vec3& point, double reach) const;
  /// Whether a point lies inside a closed mesh.
  bool contains(const Vec3& point) const;
  /// Whether any triangle meets a box of these half sides, whose own axes are the columns of `axes`.
  bool meets_box(const Vec3& center, const Mat3& axes, const Vec3& half) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box = {};
    std::int32_t left = -1;            // children at left and left + 1; −1: a leaf
    std::uint32_t begin = 0, end = 0;  // of a leaf, in triangles_
  };
  using Triangle = std::array<Vec3, 3>;
  void split(std::size_t node);
  template <class Enters, class Visit>
  void walk(const Enters& enters, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

/// m: of a ray into a sphere about `center`, from outside; a start inside meets it at 0. None where it
/// misses.
std::optional<double> meet_sphere(const Vec3& from, const Vec3& direction, double length, const Vec3& center,
                                  double radius);

}  // namespace lodestone
