#include "reference/mesh/inside.h"

#include <algorithm>
#include <cmath>

#include "reference/error.h"

namespace lodestone {
namespace {

/// +1 where the edge from `a` to `b`, seen along z, passes upwards (in y) to the right of `point`, −1
/// downwards, else 0. The half-open rule on y and one formula for both directions make neighbouring faces
/// agree to the last bit, so a closed surface has no chinks.
int count_passing(const Vec3& a, const Vec3& b, double x, double y) {
  const bool a_below = a.y() <= y, b_below = b.y() <= y;
  if (a_below == b_below) return 0;
  const Vec3 &low = a_below ? a : b, &high = a_below ? b : a;
  const double side = (high.x() - low.x()) * (y - low.y()) - (high.y() - low.y()) * (x - low.x());
  return side > 0.0 ? (a_below ? 1 : -1) : 0;
}

/// Where and in what sense the vertical line through (x, y) passes through a face: sense +1 where the face
/// looks up.
struct Crossing {
  double z = 0.0;
  int sense = 0;
};

Crossing find_crossing(const Vec3& a, const Vec3& b, const Vec3& c, double x, double y) {
  const int sense = count_passing(a, b, x, y) + count_passing(b, c, x, y) + count_passing(c, a, x, y);
  if (sense == 0) return {};
  const Vec3 normal = (b - a).cross(c - a);
  const double z = a.z() - ((x - a.x()) * normal.x() + (y - a.y()) * normal.y()) / normal.z();
  // Within the face's own heights, whatever the rounding for a face that stands almost upright.
  return {std::clamp(z, std::min({a.z(), b.z(), c.z()}), std::max({a.z(), b.z(), c.z()})), sense};
}

/// A column of the grid: all crossings of its centre line, from below.
using Column = std::vector<Crossing>;

struct Grid {
  Vec3 low;  ///< centre of the first cell
  double cell;
  std::array<int, 3> counts;
};

Grid make_grid(const Mesh& mesh, double cell) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  const Vec3 cells = (box.sizes() / cell).array().ceil().max(1.0);
  check_that(cells.prod() < 1e9, "at most 1e9 cells");
  const Vec3 low = box.center() - 0.5 * cell * (cells - Vec3::Ones());
  return {low, cell, {int(cells.x()), int(cells.y()), int(cells.z())}};
}

std::vector<Column> find_columns(const Mesh& mesh, const Grid& grid) {
  std::vector<Column> columns(std::size_t(grid.counts[0]) * grid.counts[1]);
  for (const auto& face : mesh.faces) {
    const Vec3 &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
    const Vec3 low = (a.cwiseMin(b).cwiseMin(c) - grid.low) / grid.cell,
               high = (a.cwiseMax(b).cwiseMax(c) - grid.low) / grid.cell;
    const int last_i = std::min(grid.counts[0] - 1, int(std::ceil(high.x()))),
              last_j = std::min(grid.counts[1] - 1, int(std::ceil(high.y())));
    for (int i = std::max(0, int(std::floor(low.x()))); i <= last_i; ++i)
      for (int j = std::max(0, int(std::floor(low.y()))); j <= last_j; ++j) {
        const Crossing crossing =
            find_crossing(a, b, c, grid.low.x() + i * grid.cell, grid.low.y() + j * grid.cell);
        if (crossing.sense != 0) columns[std::size_t(i) * grid.counts[1] + j].push_back(crossing);
      }
  }
  for (Column& column : columns)
    std::sort(column.begin(), column.end(), [](const Crossing& p, const Crossing& q) { return p.z < q.z; });
  return columns;
}

}  // namespace

int winding_number(const Mesh& mesh, const Vec3& point) {
  int winding = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Crossing crossing =
        find_crossing(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], point.x(), point.y());
    if (crossing.sense != 0 && crossing.z > point.z()) winding += crossing.sense;
  }
  return winding;
}

std::vector<Vec3> find_inside_points(const Mesh& mesh, double cell_m) {
  check_that(cell_m > 0.0 && !mesh.vertices.empty(), "a grid needs cells and a mesh");
  const Grid grid = make_grid(mesh, cell_m);
  const std::vector<Column> columns = find_columns(mesh, grid);
  std::vector<Vec3> points;
  for (int i = 0; i < grid.counts[0]; ++i)
    for (int j = 0; j < grid.counts[1]; ++j) {
      const Column& column = columns[std::size_t(i) * grid.counts[1] + j];
      std::size_t passed = 0;
      int winding = 0;
      for (int k = 0; k < grid.counts[2]; ++k) {
        const Vec3 point = grid.low + grid.cell * Vec3(i, j, k);
        for (; passed < column.size() && column[passed].z <= point.z(); ++passed)
          winding -= column[passed].sense;
        if (winding > 0) points.push_back(point);
      }
    }
  return points;
}

}  // namespace lodestone
