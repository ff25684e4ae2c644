// The support function of a hull: a start from the cube map, then the climb.
#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "reference/hull/hull.h"
#include "reference/hull/spiral_directions.h"

namespace lodestone {
namespace {

/// The middle of cell (u, v) of a face of the cube; `face` is 2 × axis + (1 on the negative side).
Vec3 cell_direction(int face, int u, int v, int side) {
  const int axis = face / 2;
  Vec3 direction;
  direction[axis] = face % 2 == 0 ? 1.0 : -1.0;
  direction[(axis + 1) % 3] = (u + 0.5) * 2.0 / side - 1.0;
  direction[(axis + 2) % 3] = (v + 0.5) * 2.0 / side - 1.0;
  return direction;
}

}  // namespace

int find_support(const Hull& hull, const Vec3& direction, int start) {
  int best = start;
  double height = hull.vertices[start].dot(direction);
  for (bool higher = true; higher;) {
    higher = false;
    for (int i : hull.neighbors(best)) {
      const double other = hull.vertices[i].dot(direction);
      if (other > height) {
        height = other;
        best = i;
        higher = true;
      }
    }
  }
  return best;
}

SupportMap::SupportMap(const Hull& hull, int side) : side_(side) {
  check_that(side > 0 && !hull.vertices.empty(), "a support map needs cells and a hull");
  cells_.reserve(6 * side * side);
  int vertex = 0;
  for (int face = 0; face < 6; ++face)
    for (int v = 0; v < side; ++v)
      for (int u = 0; u < side; ++u) {
        vertex = find_support(hull, cell_direction(face, u, v, side), vertex);
        // A hull of more than 65,536 vertices (far beyond use) climbs from vertex 0: slower, equally exact.
        cells_.push_back(vertex <= 0xffff ? std::uint16_t(vertex) : 0);
      }
}

SupportMapError find_lookup_error(const Hull& hull, const SupportMap& map) {
  constexpr int kDirections = 20'000;
  SupportMapError error;
  for (int i = 0; i < kDirections; ++i) {
    const Vec3 direction = spiral_direction(i, kDirections);
    const int start = map.find_start(direction), exact = find_support(hull, direction, start);
    const double missed = (hull.vertices[exact] - hull.vertices[start]).dot(direction);
    error.mean += missed / kDirections;
    error.greatest = std::max(error.greatest, missed);
  }
  return error;
}

int SupportMap::find_start(const Vec3& direction) const {
  const Vec3 size = direction.cwiseAbs();
  const int axis = size.x() >= size.y() ? (size.x() >= size.z() ? 0 : 2) : (size.y() >= size.z() ? 1 : 2);
  constexpr int kNext[] = {1, 2, 0}, kAfterNext[] = {2, 0, 1};
  const double half = 0.5 * side_, scale = half / size[axis];
  const auto cell_of = [&](double coordinate) {
    const double cell = half + coordinate * scale;  // NaN where the direction is zero or not finite: cell 0
    return cell >= 0.0 && cell < side_ ? int(cell) : (cell >= side_ ? side_ - 1 : 0);
  };
  const int face = 2 * axis + (direction[axis] < 0.0);
  return cells_[(face * side_ + cell_of(direction[kAfterNext[axis]])) * side_ +
                cell_of(direction[kNext[axis]])];
}

}  // namespace lodestone
