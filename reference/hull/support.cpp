// The support function of a hull: a start from the cube map, then the climb.
#include <algorithm>

#include "reference/error.h"
#include "reference/hull/hull.h"
#include "reference/hull/spiral_directions.h"

namespace lodestone {

// Without a branch for each neighbour: which of them is higher, no processor foretells.
int find_support(const Hull& hull, const Vec3& direction, int start) {
  int best = start;
  double height = hull.vertices[std::size_t(start)].dot(direction);
  while (true) {
    int next = best;
    for (const std::int32_t i : hull.neighbors(best)) {
      const double other = hull.vertices[std::size_t(i)].dot(direction);
      next = other > height ? i : next;
      height = std::max(height, other);
    }
    if (next == best) return best;
    best = next;
  }
}

SupportMap::SupportMap(const Hull& hull, int side) : cells_(side) {
  check_that(side > 0 && !hull.vertices.empty(), "a support map needs cells and a hull");
  vertices_.reserve(std::size_t(cells_.size()));
  int vertex = 0;
  for (int cell = 0; cell < cells_.size(); ++cell) {
    vertex = find_support(hull, cells_.middle_of(cell), vertex);
    // A hull of more than 65,536 vertices (far beyond use) climbs from vertex 0: slower, equally exact.
    vertices_.push_back(vertex <= 0xffff ? std::uint16_t(vertex) : 0);
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

}  // namespace lodestone
