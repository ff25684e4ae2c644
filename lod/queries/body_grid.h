// Where all bodies are, asleep or not: each in the cells that its ball meets, in a hash table, with cells of
// the sizes that there are bodies of. Balls are drawn larger than they are, so that one that has moved little
// stays where it is.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

class BodyGrid {
 public:
  /// Puts a body in, or where it is now. `radius` > 0, m.
  void put(std::uint32_t body, const Vec3& position, double radius);
  void forget(std::uint32_t body);
  void clear() { *this = {}; }
  std::size_t size() const { return bodies_; }

  /// Calls found(body), perhaps more than once, for every body whose ball may meet the box, and some more.
  template <class Found>
  void find_near(const Eigen::AlignedBox3d& box, const Found& found) const;

  /// Calls found(body), perhaps more than once, for those whose ball may come within `margin` m of a ray
  /// (direction of unit length), near ones mostly first. What it returns is how much of the ray is still of
  /// interest, m.
  template <class Found>
  void find_along(const Vec3& from, const Vec3& direction, double length, double margin,
                  const Found& found) const;

 private:
  static constexpr std::uint32_t kNone = ~0u;
  static constexpr int kLevels = 64, kBaseLevel = 32;
  struct Key {
    std::int32_t x = 0, y = 0, z = 0, level = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Cell {
    Key key;
    std::uint32_t head = kNone;
    bool used = false;
  };
  struct Entry {
    std::uint32_t body = 0, next = kNone;
  };
  struct Place {
    Vec3 position = Vec3::Zero();
    double radius = 0.0;  // 0: not in the grid
  };
  struct Range {
    std::array<std::int32_t, 3> low{}, high{};
  };

  static int level_of(double radius);
  static double edge_of(int level) { return std::ldexp(1.0, level - kBaseLevel); }
  static std::int32_t along(double at) {
    return std::int32_t(std::floor(std::fmin(std::fmax(at, -2e9), 2e9)));
  }
  static Range range_of(const Eigen::AlignedBox3d& box, int level);
  /// m along the ray: from where to where it may be within `margin` of the bounds; from beyond `to` if
  /// nowhere.
  struct Part {
    double from = 0.0, to = 0.0;
  };
  static Part part_within(const Eigen::AlignedBox3d& bounds, const Vec3& from, const Vec3& direction,
                          double length, double margin);
  static bool comes_near(const Place& place, const Vec3& from, const Vec3& direction, double length,
                         double margin);
  void note_bounds(const Place& place);
  std::size_t place_of(const Key& key) const;
  const Cell* find(const Key& key) const;
  void grow();
  template <class Visit>
  void each_cell(const Place& place, const Visit& visit) const;
  void take_out(std::uint32_t body);

  std::vector<Place> places_;  // of each body
  std::vector<Cell> cells_;    // a power of two
  std::size_t used_ = 0, bodies_ = 0;
  std::vector<Entry> entries_;
  std::uint32_t free_entry_ = kNone;
  std::array<std::uint32_t, kLevels> of_level_{};      // bodies
  std::array<Eigen::AlignedBox3d, kLevels> bounds_{};  // m, of their balls, and of some that have gone
};

template <class Found>
void BodyGrid::find_near(const Eigen::AlignedBox3d& box, const Found& found) const {
  for (int level = 0; level < kLevels; ++level) {
    if (of_level_[std::size_t(level)] == 0) continue;
    const Range range = range_of(box, level);
    double cells = 1.0;
    for (std::size_t a = 0; a < 3; ++a) cells *= double(range.high[a]) - double(range.low[a]) + 1.0;
    if (cells > double(cells_.size())) {  // more than there are
      for (std::uint32_t body = 0; body < places_.size(); ++body)
        if (places_[body].radius > 0.0 && level_of(places_[body].radius) == level) found(body);
      continue;
    }
    for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z)
      for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y)
        for (std::int32_t x = range.low[0]; x <= range.high[0]; ++x)
          if (const Cell* cell = find({x, y, z, level}))
            for (std::uint32_t entry = cell->head; entry != kNone; entry = entries_[entry].next)
              found(entries_[entry].body);
  }
}

// From cell to cell (Amanatides and Woo, A fast voxel traversal algorithm, 1987), on what of the ray is
// within the bounds of the bodies. A ray with a margin is cut into boxes.
template <class Found>
void BodyGrid::find_along(const Vec3& from, const Vec3& direction, double length, double margin,
                          const Found& found) const {
  double left = length;
  for (int level = 0; level < kLevels; ++level) {
    if (of_level_[std::size_t(level)] == 0) continue;
    const double edge = edge_of(level);
    const auto [begin, end] = part_within(bounds_[std::size_t(level)], from, direction, left, margin);
    if (begin > end) continue;
    const Vec3 start = from + begin * direction;
    constexpr double kFarthestCell = 1e9;            // along() knows no farther ones
    const double thick = 2.0 * margin / edge + 2.0;  // cells
    const bool looks_at_more = margin > 0.0
                                   ? thick * thick * ((end - begin) / edge + thick) > double(places_.size())
                                   : (end - begin) / edge > 4.0 * double(cells_.size());
    if (looks_at_more || !(start.cwiseAbs().maxCoeff() < kFarthestCell * edge)) {
      for (std::uint32_t body = 0; body < places_.size(); ++body) {
        const Place& place = places_[body];
        if (place.radius > 0.0 && level_of(place.radius) == level &&
            comes_near(place, from, direction, left, margin))
          left = std::min(left, found(body));
      }
    } else if (margin > 0.0) {
      const double piece = std::max(edge, 2.0 * margin);
      for (double at = begin; at <= std::min(left, end); at += piece) {
        const Vec3 first = from + at * direction, last = from + std::min({at + piece, left, end}) * direction,
                   around = Vec3::Constant(margin);
        const Range range = range_of({first.cwiseMin(last) - around, first.cwiseMax(last) + around}, level);
        for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z)
          for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y)
            for (std::int32_t x = range.low[0]; x <= range.high[0]; ++x)
              if (const Cell* cell = find({x, y, z, level}))
                for (std::uint32_t entry = cell->head; entry != kNone; entry = entries_[entry].next)
                  left = std::min(left, found(entries_[entry].body));
      }
    } else {
      std::array<std::int32_t, 3> cell{}, step{};
      std::array<double, 3> next{}, across{};
      for (int a = 0; a < 3; ++a) {
        const auto i = std::size_t(a);
        cell[i] = along(start[a] / edge);
        step[i] = direction[a] > 0.0 ? 1 : -1;
        across[i] = direction[a] == 0.0 ? 1e300 : edge / std::abs(direction[a]);
        next[i] = direction[a] == 0.0
                      ? 1e300
                      : begin + ((cell[i] + (direction[a] > 0.0)) * edge - start[a]) / direction[a];
      }
      for (double at = begin; at <= std::min(left, end);) {
        if (const Cell* here = find({cell[0], cell[1], cell[2], level}))
          for (std::uint32_t entry = here->head; entry != kNone; entry = entries_[entry].next)
            left = std::min(left, found(entries_[entry].body));
        const std::size_t a = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        at = next[a];
        next[a] += across[a];
        cell[a] += step[a];
      }
    }
  }
}

}  // namespace lodestone
