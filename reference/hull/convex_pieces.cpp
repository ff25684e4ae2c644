#include "reference/hull/convex_pieces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reference/error.h"
#include "reference/mesh/inside.h"
#include "reference/mesh/mass_properties.h"

namespace lodestone {
namespace {

constexpr std::size_t kMostPlanes = 24, kMostCells = 256, kMostPieces = 16;
constexpr double kFlat = 1e-7;        // × size: nearer to a plane is on it
constexpr double kSameVolume = 1e-6;  // of the volume compared with

struct Plane {
  Vec3 normal;
  double offset;
};

struct Cell {
  Hull hull;
  double volume = 0.0;
  Vec3 center = Vec3::Zero();
};

Mesh mesh_of(const Hull& hull) { return {hull.vertices, hull.faces}; }

/// Nothing where the points bound no volume to speak of.
std::optional<Cell> make_cell(std::span<const Vec3> points, double least_volume) {
  try {
    Cell cell{make_hull(points)};
    const MassProperties mass = measure_mass_properties(mesh_of(cell.hull));
    cell.volume = mass.volume;
    cell.center = mass.center_of_mass;
    return cell.volume > least_volume ? std::optional(std::move(cell)) : std::nullopt;
  } catch (const InputError&) {  // the points lie in a plane: that is the answer
    return {};
  }
}

class Decomposition {
 public:
  Decomposition(const Mesh& mesh, const Hull& hull) : mesh_(mesh), hull_(hull) {
    Eigen::AlignedBox3d bounds;
    for (const Vec3& vertex : hull.vertices) bounds.extend(vertex);
    size_ = bounds.sizes().maxCoeff();
    volume_ = measure_mass_properties(mesh).volume;
  }

  std::vector<Hull> run() {
    if (!find_planes() || !cut() || !keep_inside()) return {};
    return join();
  }

 private:
  /// Those of faces that do not lie on the hull; false where they are too many.
  bool find_planes() {
    std::vector<Plane> outer;
    for (int i = 0; i < int(hull_.faces.size()); ++i)
      add_plane(outer, hull_.area_vector(i), hull_.vertices[hull_.faces[i][0]]);
    std::vector<Plane> all = outer;
    for (const auto& [a, b, c] : mesh_.faces) {
      const Vec3 corner = mesh_.vertices[a];
      add_plane(all, (mesh_.vertices[b] - corner).cross(mesh_.vertices[c] - corner), corner);
      if (all.size() > outer.size() + kMostPlanes) return false;
    }
    planes_.assign(all.begin() + std::ptrdiff_t(outer.size()), all.end());
    return true;
  }
  void add_plane(std::vector<Plane>& planes, const Vec3& raw_normal, const Vec3& point) const {
    const Vec3 normal = raw_normal.normalized();
    const double offset = normal.dot(point);
    const auto same = [&](const Plane& plane) {
      const double side = plane.normal.dot(normal);
      return std::abs(side) > 1.0 - 1e-9 &&
             std::abs(plane.offset - (side < 0.0 ? -offset : offset)) < kFlat * size_;
    };
    if (raw_normal.norm() > 0.0 && std::ranges::none_of(planes, same)) planes.push_back({normal, offset});
  }

  bool cut() {
    cells_.push_back(*make_cell(hull_.vertices, 0.0));
    for (const Plane& plane : planes_) {
      std::vector<Cell> next;
      for (Cell& cell : cells_) cut_cell(std::move(cell), plane, next);
      cells_ = std::move(next);
      if (cells_.size() > kMostCells) return false;
    }
    return true;
  }
  void cut_cell(Cell cell, const Plane& plane, std::vector<Cell>& into) const {
    std::vector<double> height;
    for (const Vec3& vertex : cell.hull.vertices) height.push_back(plane.normal.dot(vertex) - plane.offset);
    const double flat = kFlat * size_;
    if (std::ranges::max(height) < flat || std::ranges::min(height) > -flat)
      return into.push_back(std::move(cell));
    std::vector<Vec3> above, below;
    for (int i = 0; i < int(height.size()); ++i) {
      if (height[i] > -flat) above.push_back(cell.hull.vertices[i]);
      if (height[i] < flat) below.push_back(cell.hull.vertices[i]);
      for (const int j : cell.hull.neighbors(i))
        if (height[i] > flat && height[j] < -flat) {
          const double share = height[i] / (height[i] - height[j]);
          const Vec3 point = cell.hull.vertices[i] + share * (cell.hull.vertices[j] - cell.hull.vertices[i]);
          above.push_back(point);
          below.push_back(point);
        }
    }
    for (const auto& points : {above, below})
      if (auto part = make_cell(points, 1e-3 * kSameVolume * volume_)) into.push_back(std::move(*part));
  }

  bool keep_inside() {
    std::erase_if(cells_, [&](const Cell& cell) { return winding_number(mesh_, cell.center) <= 0; });
    double sum = 0.0;
    for (const Cell& cell : cells_) sum += cell.volume;
    return std::abs(sum - volume_) < kSameVolume * volume_;
  }

  struct Union {
    Cell whole;
    std::vector<int> cells;  // sorted
  };

  /// The largest convex union that grows from a cell, always by the largest neighbour that keeps it convex.
  Union grow(int seed) const {
    Union grown{cells_[seed], {seed}};
    for (bool more = true; more;) {
      more = false;
      for (const int i : by_volume_) {
        if (std::ranges::find(grown.cells, i) != grown.cells.end()) continue;
        if (auto joined = join_convex(grown.whole, cells_[i])) {
          grown.whole = std::move(*joined);
          grown.cells.push_back(i);
          more = true;
        }
      }
    }
    std::ranges::sort(grown.cells);
    return grown;
  }
  /// Where it lies on a plane, and on one side of it: the corners there, and the sign of that side.
  struct Side {
    Eigen::AlignedBox3d corners;
    int sign = 0;  // 0: on both
  };
  Side side_of(const Cell& cell, const Plane& plane) const {
    Side side;
    double low = 0.0, high = 0.0;
    for (const Vec3& vertex : cell.hull.vertices) {
      const double height = plane.normal.dot(vertex) - plane.offset;
      low = std::min(low, height), high = std::max(high, height);
      if (std::abs(height) < kFlat * size_) side.corners.extend(vertex);
    }
    const bool above = low > -kFlat * size_, below = high < kFlat * size_;
    side.sign = above ? 1 : below ? -1 : 0;
    return side;
  }
  /// Without it two that do not overlap have no convex union: that has one section by the plane between them.
  /// Many times as cheap as the union.
  bool share_face(const Cell& a, const Cell& b) const {
    const double same = 10.0 * kFlat * size_;
    return std::ranges::any_of(planes_, [&](const Plane& plane) {
      const Side of_a = side_of(a, plane);
      if (of_a.sign == 0 || of_a.corners.isEmpty()) return false;
      const Side of_b = side_of(b, plane);
      return of_b.sign == -of_a.sign && !of_b.corners.isEmpty() &&
             (of_a.corners.min() - of_b.corners.min()).lpNorm<Eigen::Infinity>() < same &&
             (of_a.corners.max() - of_b.corners.max()).lpNorm<Eigen::Infinity>() < same;
    });
  }
  std::optional<Cell> join_convex(const Cell& a, const Cell& b) const {
    if (!share_face(a, b)) return {};
    std::vector<Vec3> points = a.hull.vertices;
    points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
    auto joined = make_cell(points, 0.0);
    const double sum = a.volume + b.volume;
    if (!joined || joined->volume > sum + kSameVolume * std::min(a.volume, b.volume)) return {};
    return joined;
  }

  /// Unions until every cell is in one, largest first.
  std::vector<Hull> join() {
    for (int i = 0; i < int(cells_.size()); ++i) by_volume_.push_back(i);
    std::ranges::stable_sort(by_volume_, std::ranges::greater{}, [&](int i) { return cells_[i].volume; });
    std::vector<Union> unions;
    for (const int seed : by_volume_)
      if (Union grown = grow(seed);
          std::ranges::none_of(unions, [&](const Union& other) { return other.cells == grown.cells; }))
        unions.push_back(std::move(grown));
    std::ranges::stable_sort(unions, std::ranges::greater{}, [](const Union& u) { return u.whole.volume; });
    std::vector<bool> covered(cells_.size(), false);
    std::vector<Hull> pieces;
    for (const Union& each : unions) {
      if (std::ranges::all_of(each.cells, [&](int i) { return covered[i]; })) continue;
      for (const int i : each.cells) covered[i] = true;
      pieces.push_back(each.whole.hull);
    }
    return pieces.size() <= kMostPieces ? pieces : std::vector<Hull>{};
  }

  const Mesh& mesh_;
  const Hull& hull_;
  double size_ = 0.0, volume_ = 0.0;
  std::vector<Plane> planes_;
  std::vector<Cell> cells_;
  std::vector<int> by_volume_;
};

}  // namespace

std::vector<Hull> find_convex_pieces(const Mesh& mesh, const Hull& hull) {
  return Decomposition(mesh, hull).run();
}

}  // namespace lodestone
