// Which vertices of a hull may be among the farthest along a direction: of a hull with many, a search for
// those that a plane cuts off needs to look at no others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reference/hull/cube_map.h"
#include "reference/hull/hull.h"

namespace lodestone {

class TipMap {
 public:
  static constexpr double kDepth = 0.03;     ///< over R
  static constexpr std::size_t kMost = 192;  ///< vertices of a cell

  TipMap() = default;
  /// `radius`: R, the greatest distance of a vertex from the origin, m.
  TipMap(const Hull& hull, double radius);

  /// In the hull's order, all vertices that lie less than kDepth × R short of the farthest along `direction`
  /// (any length), and some more. None, where they are too many, or the hull has so few that a loop over all
  /// of them is as quick.
  std::span<const std::uint16_t> find(const Vec3& direction) const {
    if (first_.empty()) return {};
    const auto cell = std::size_t(cells_.cell_of(direction));
    return std::span(vertices_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

 private:
  CubeMap cells_;
  std::vector<std::uint32_t> first_;  // of each cell, and one more
  std::vector<std::uint16_t> vertices_;
};

}  // namespace lodestone
