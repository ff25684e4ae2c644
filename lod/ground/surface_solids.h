// A surface of triangles as ground: each is a solid, as deep as the surface lets it be. It is made when
// something first comes near, as a solid takes a hundred times the memory of its triangle and most of a
// landscape lies idle.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "lod/ground/deep_triangles.h"
#include "lod/ground/ground_solid.h"
#include "reference/mesh/mesh.h"

namespace lodestone {

/// Whether it is more than a line, or a sliver of no width.
bool has_area(const Mesh& mesh, const std::array<int, 3>& face);

class SurfaceSolids {
 public:
  /// Faces counter-clockwise from outside, vertices in the part's frame, m. Faces without area are left out.
  explicit SurfaceSolids(const Mesh& mesh);
  ~SurfaceSolids();
  SurfaceSolids(const SurfaceSolids&) = delete;
  SurfaceSolids& operator=(const SurfaceSolids&) = delete;

  std::size_t size() const { return triangles_.size(); }
  const Eigen::AlignedBox3d& bounds() const { return deep_.bounds(); }  ///< m: of all that is solid, at most
  /// Appends those that may be solid within `reach` m of `center`, counted from `first`.
  void find_near(const Vec3& center, double reach, int first, std::vector<int>& found) const {
    deep_.find_near(center, reach, first, found);
  }
  /// The corners of those triangles that stand in boxes (AlignedBox3d) which `enters`: some may be beside it.
  template <class Enters, class Visit>
  void visit_triangles(const Enters& enters, const Visit& visit) const {
    const auto visit_one = [&](int i) { visit(corners_of(triangles_[std::size_t(i)])); };
    if (tree_.empty()) return deep_.visit_bare(enters, visit_one);
    tree_.visit_places(enters, [&](std::int32_t place) { visit_one(tree_.number_at(place)); });
  }
  /// For any thread at any time; stays where it is.
  const GroundSolid& operator[](std::size_t i) const;
  /// How many of them something has come near.
  std::size_t made() const;

 private:
  struct Triangle {
    std::array<int, 3> corner;  // in vertices_
    std::array<bool, 3> ridge;
    std::array<double, 3> cosine;  // as of SurfaceTriangle
    bool reversed = false;         // there again, seen from the other side
  };

  std::array<Vec3, 3> corners_of(const Triangle& triangle) const;
  std::optional<OneWay> find_one_way() const;
  void find_reversed();
  std::array<double, 3> find_thickness(const std::array<Vec3, 3>& corner, const Vec3& normal,
                                       bool reversed) const;
  double find_thickness_at(const Vec3& point, const Vec3& normal) const;
  bool is_backed(const std::array<Vec3, 3>& corner, const Vec3& normal) const;
  template <class Visit>
  void visit_crossings(const Vec3& from, const Vec3& direction, const Visit& visit) const;
  GroundSolid make(const Triangle& triangle) const;

  std::vector<Vec3> vertices_;  // m
  std::vector<Triangle> triangles_;
  DeepTriangles deep_;  // by number
  BoxHierarchy tree_;   // of the triangles themselves, for rays; empty where none meets another side
  double size_ = 0.0;   // m, the diagonal of all
  double depth_ = 0.0;  // m: so far below the surface each is solid, at most
  std::unique_ptr<std::atomic<const GroundSolid*>[]> solids_;  // of each triangle; null: not made yet
};

}  // namespace lodestone
