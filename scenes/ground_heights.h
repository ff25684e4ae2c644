// How high the ground of a scene is under a body: where scatters put what stands on it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace lodestone {

class GroundHeights {
 public:
  explicit GroundHeights(std::span<const SceneGround> ground);

  /// z (m) of the highest ground, whatever is above it or below, under the middle of a disc about `center`,
  /// its edge and half way between, at eight points each. None: no ground there.
  std::optional<double> highest_under(const Vec3& center, double radius) const;

  /// Where a body of `shape` lies with its side down that `orientation` has down, turned to the slope about
  /// its middle there and by `turn_rad` about the slope's normal: its lowest vertex on the ground under
  /// `center`, whose height does not count. None: no ground there, or none as flat as a tenth of its radius.
  std::optional<RigidState> lay(const Shape& shape, const Quat& orientation, double turn_rad,
                                const Vec3& center) const;

 private:
  /// The triangles of a mesh, by the cells of a grid over it that their bounding rectangles meet.
  struct Grid {
    explicit Grid(const Mesh& mesh);
    std::optional<double> height_at(double x, double y) const;
    std::array<int, 2> cell_of(double x, double y) const;
    static constexpr int kCells = 64;  // along a side
    Mesh mesh;
    Eigen::AlignedBox3d bounds;
    std::vector<std::vector<int>> faces;
  };
  std::optional<double> height_at(double x, double y) const;

  std::vector<GroundPlane> planes_;
  std::vector<Grid> grids_;
};

}  // namespace lodestone
