#include "reference/mesh/mesh_weld.h"

#include <xxhash.h>

#include <cmath>
#include <numeric>
#include <unordered_map>

namespace lodestone {
namespace {

/// For each vertex the first one within `distance`, on a grid of cells twice that wide.
std::vector<int> find_twins(std::span<const Vec3> vertices, double distance) {
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const { return XXH3_64bits(cell.data(), sizeof(cell)); }
  };
  const Vec3 origin = std::accumulate(vertices.begin(), vertices.end(), Vec3(vertices.front()),
                                      [](const Vec3& a, const Vec3& b) { return Vec3(a.cwiseMin(b)); });
  const auto cell_of = [&](const Vec3& point, int i) {
    return std::int64_t(std::floor((point[i] - origin[i]) / (2.0 * distance)));
  };
  std::unordered_multimap<Cell, int, CellHash> seen;
  seen.reserve(vertices.size());

  std::vector<int> twins(vertices.size());
  for (int i = 0; i < int(vertices.size()); ++i) {
    const Vec3 low = vertices[i].array() - distance, high = vertices[i].array() + distance;
    int twin = i;
    for (auto x = cell_of(low, 0); x <= cell_of(high, 0); ++x)
      for (auto y = cell_of(low, 1); y <= cell_of(high, 1); ++y)
        for (auto z = cell_of(low, 2); z <= cell_of(high, 2); ++z)
          for (auto [place, end] = seen.equal_range(Cell{x, y, z}); place != end; ++place)
            if ((vertices[place->second] - vertices[i]).norm() <= distance)
              twin = std::min(twin, place->second);
    twins[i] = twin;
    if (twin == i)
      seen.emplace(Cell{cell_of(vertices[i], 0), cell_of(vertices[i], 1), cell_of(vertices[i], 2)}, i);
  }
  return twins;
}

}  // namespace

int weld_vertices(Mesh& mesh, double distance_m) {
  const std::vector<int> twins = find_twins(mesh.vertices, distance_m);
  for (auto& face : mesh.faces)
    for (int& i : face) i = twins[i];
  int welded = 0;
  for (int i = 0; i < int(twins.size()); ++i) welded += twins[i] != i;
  return welded;
}

}  // namespace lodestone
