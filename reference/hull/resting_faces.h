// On which faces a convex body can stand and what it takes to tip it off them: statics, from the hull alone.
// The height of the centre of mass over the plane, as a function of the plane's normal in body axes, has its
// minima at the stable faces. A body without the energy to get over the passes around some of them stays
// among these. (Goldberg, Mirtich, Zhuang, Craig, Carlisle, Canny: Part pose statistics, 1999.)
#pragma once

#include <array>
#include <vector>

#include "reference/geometry.h"
#include "reference/hull/hull.h"

namespace lodestone {

/// A stable face: the foot of the centre of mass lies within it. Triangles of one plane count as one face.
struct RestingFace {
  Vec3 normal = Vec3::UnitZ();  ///< the plane's normal in body axes when the body stands on it: into the body
  double height = 0.0;          ///< m, of the centre of mass over the plane
  /// m, height that the centre of mass must reach to get to a lower stable face; infinite for the lowest.
  double pass = 0.0;
};

class RestingFaces {
 public:
  /// About the origin, which must be the centre of mass. `hull` must outlive it.
  explicit RestingFaces(const Hull& hull);

  /// Lowest first.
  const std::vector<RestingFace>& faces() const { return faces_; }

  /// The face onto which the body tips when let down without speed, touching the plane, whose normal in body
  /// axes is `normal`.
  int find_quasistatic(const Vec3& normal) const;

  /// The face on which a body that touches the plane is bound to end: its energy lifts its centre of mass no
  /// higher than `energy_height` (m). −1 where that leaves faces more than `same_angle` (rad) apart.
  int find_certain(const Vec3& normal, double energy_height, double same_angle) const;

  /// Whether a body that lies on the face with `normal` stays there while it is pulled along `down` (of any
  /// length): from the centre of mass that leads through the face. Both in body axes; of whatever size the
  /// body is.
  bool holds(const Vec3& normal, const Vec3& down) const;

 private:
  struct Triangle {
    std::array<int, 3> corner, across;  // `across[i]`: the triangle beyond the edge from corner i to the next
    Vec3 normal;                        // into the body
    double height = 0.0;
  };
  // Triangles join into ever larger parts of the hull at the height of the pass between them: a tree, its
  // leaves the triangles.
  struct Part {
    int parent = -1;
    double pass = 0.0;    // at which it joined its parent's other part
    int lowest = -1;      // triangle
    double spread = 0.0;  // rad, of its stable faces about the lowest
  };

  void find_triangles();
  void join_parts();
  int part_below(int triangle, double height) const;
  int roll(int triangle) const;
  int tip(const Vec3& normal) const;

  const Hull& hull_;
  double slack_ = 0.0;  // m, heights that differ by less are equal
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> triangles_at_;  // of each vertex
  std::vector<Part> parts_;
  std::vector<int> face_of_;  // of each triangle; −1: not stable
  std::vector<RestingFace> faces_;
};

}  // namespace lodestone
