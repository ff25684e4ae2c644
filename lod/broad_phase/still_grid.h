// Where bodies lie that sleep: cells in a hash table, so that one falls asleep or wakes without a look at the
// others. Bodies of other sizes have cells of other sizes, each edge twice the one before. Groups of cells
// tell at a few looks where nobody lies about a place, as mostly nobody does; and who has looked once need
// not look again while nobody was laid down in his region.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "reference/geometry.h"
#include "reference/state_archive.h"

namespace lodestone {

class StillGrid {
 public:
  /// `body`: any small number, in the grid at most once. `radius` > 0, m.
  void insert(std::uint32_t body, const Vec3& position, double radius);
  /// With what it was inserted with.
  void remove(std::uint32_t body, const Vec3& position, double radius);
  bool empty() const { return bodies_ == 0; }
  std::uint64_t insertions() const { return insertions_; }  ///< ever; no part of the state
  void archive(StateArchive& a) {
    a(cells_, used_, bodies_, next_, of_level_);
    if (a.reading()) count_groups(), find_levels(), ++readings_;
  }
  std::size_t bytes() const {
    return cells_.capacity() * sizeof(Cell) +
           (next_.capacity() + arrivals_.capacity()) * sizeof(std::uint32_t) + groups_.capacity();
  }

  /// A number that changes before a body is inserted that may come within `reach` m of `center`, about balls
  /// drawn larger by a twentieth: as long as it stays, nobody new is there. None where the reach is too wide
  /// for the regions of such bodies as these. No part of the state.
  std::optional<std::uint64_t> arrivals_near(const Vec3& center, double reach) const;

  /// Calls found(body) for every body whose ball may meet this one, and for some a cell beyond, in an order
  /// that follows from what was inserted and removed.
  template <class Found>
  void find_near(const Vec3& center, double reach, const Found& found) const;

 private:
  struct Key {
    std::int32_t x = 0, y = 0, z = 0, level = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };
  static constexpr std::uint32_t kNone = ~0u;
  struct Cell {
    Key key;
    std::uint32_t head = kNone;
    bool used = false;  // or was once
  };
  static constexpr std::uint8_t kMany = 255;
  static constexpr std::size_t kGroups = 8;  // for each cell: so that few share their hash with another
  static constexpr std::size_t kRegions = 4096;
  struct Range {
    std::array<std::int32_t, 3> low, high;
  };
  static int level_of(double radius) { return std::ilogb(2.0 * radius) + 1; }
  static double edge_of(int level) { return std::ldexp(1.0, level); }
  static std::int32_t along(double at) {
    const double within = at > -2e9 ? std::min(at, 2e9) : -2e9;  // NaN, too
    const auto truncated = std::int32_t(within);
    return truncated - std::int32_t(double(truncated) > within);
  }
  static Key key_of(const Vec3& position, int level);
  static std::size_t hash_of(const Key& key);
  std::size_t place_of(const Key& key) const;
  void grow();
  static Key group_of(const Key& cell) { return {cell.x >> 2, cell.y >> 2, cell.z >> 2, cell.level}; }
  std::size_t place_of_group(const Key& group) const { return hash_of(group) & (groups_.size() - 1); }
  static double edge_of_region(int level) { return 4.0 * edge_of(level); }
  std::size_t place_of_region(const Key& region) const { return hash_of(region) & (kRegions - 1); }
  void announce(const Vec3& position, double radius, int level);
  void count_groups();
  void find_levels();
  void mark(const Key& cell);
  void unmark(const Key& cell);
  template <class Found>
  void visit_few(const Range& range, std::int32_t level, const Found& found) const;
  template <class Found>
  void visit_all(const Range& range, std::int32_t level, const Found& found) const;
  // Whether anybody lies in these groups, one by one, x first; whether in any of them.
  bool find_lived_in(std::int32_t x0, std::int32_t x1, std::int32_t y0, std::int32_t y1, std::int32_t z,
                     std::int32_t level, std::vector<std::uint8_t>& lived_in) const;
  template <class Found>
  void visit(const Cell& cell, const Found& found) const {
    for (std::uint32_t body = cell.head; body != kNone; body = next_[body]) found(body);
  }

  std::vector<Cell> cells_;  // a power of two
  std::size_t used_ = 0, bodies_ = 0;
  std::uint64_t insertions_ = 0;
  // By a group's hash, four cells wide along each axis: cells of it, and of others with that hash, that are
  // lived in; kMany for as many or more.
  std::vector<std::uint8_t> groups_;
  // By a region's hash: how many were inserted that may come near a ball whose centre lies in it, half an
  // edge wide at most.
  std::vector<std::uint32_t> arrivals_;
  std::uint64_t readings_ = 0;                   // of the archive
  std::vector<std::uint32_t> next_;              // of each body, the next one in its cell
  std::array<std::uint32_t, 128> of_level_{};    // bodies
  int lowest_level_ = 64, highest_level_ = -64;  // that any body was ever of
};

template <class Found>
void StillGrid::find_near(const Vec3& center, double reach, const Found& found) const {
  if (empty()) return;
  for (int level = lowest_level_; level <= highest_level_; ++level) {
    if (of_level_[std::size_t(level + 64)] == 0) continue;
    const double inverse = 1.0 / edge_of(level), span = reach + 0.5 * edge_of(level);
    const Vec3 low = (center - Vec3::Constant(span)) * inverse,
               high = (center + Vec3::Constant(span)) * inverse;
    const double cells = (high - low + Vec3::Constant(2.0)).prod();
    if (cells > 2.0 * double(cells_.size())) {  // larger than the whole table
      for (const Cell& cell : cells_)
        if (cell.key.level == level) visit(cell, found);
      continue;
    }
    const Range range{{along(low.x()), along(low.y()), along(low.z())},
                      {along(high.x()), along(high.y()), along(high.z())}};
    const auto in_two_groups = [&](int axis) {
      return std::int64_t(range.high[axis] >> 2) - (range.low[axis] >> 2) <= 1;
    };
    if (in_two_groups(0) && in_two_groups(1) && in_two_groups(2))
      visit_few(range, level, found);
    else
      visit_all(range, level, found);
  }
}

// Of a range that lies in two groups along each axis at most. In the order of cells: x first, then y, then z.
template <class Found>
void StillGrid::visit_few(const Range& range, std::int32_t level, const Found& found) const {
  const Key first{range.low[0] >> 2, range.low[1] >> 2, range.low[2] >> 2, level};
  unsigned lived_in = 0;  // a bit for each group: x + 2 y + 4 z
  for (int z = 0; z <= (range.high[2] >> 2) - first.z; ++z)
    for (int y = 0; y <= (range.high[1] >> 2) - first.y; ++y)
      for (int x = 0; x <= (range.high[0] >> 2) - first.x; ++x)
        lived_in |= unsigned(groups_[place_of_group({first.x + x, first.y + y, first.z + z, level})] != 0)
                    << (x + 2 * y + 4 * z);
  if (lived_in == 0) return;
  const std::int32_t middle = 4 * first.x + 4;  // where the second group begins
  for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z)
    for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y) {
      const unsigned row = lived_in >> (2 * ((y >> 2) - first.y) + 4 * ((z >> 2) - first.z));
      const std::int32_t begin = row & 1 ? range.low[0] : std::max(range.low[0], middle),
                         end = row & 2 ? range.high[0] : std::min(range.high[0], middle - 1);
      for (std::int32_t x = begin; x <= end; ++x) visit(cells_[place_of({x, y, z, level})], found);
    }
}

// In the same order.
template <class Found>
void StillGrid::visit_all(const Range& range, std::int32_t level, const Found& found) const {
  thread_local std::vector<std::uint8_t> lived_in;  // groups of a layer, x first
  const std::int32_t x0 = range.low[0] >> 2, y0 = range.low[1] >> 2, x1 = range.high[0] >> 2,
                     y1 = range.high[1] >> 2;
  const auto width = std::size_t(x1 - x0 + 1);
  bool any = false;
  for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z) {
    if (z == range.low[2] || z % 4 == 0) any = find_lived_in(x0, x1, y0, y1, z >> 2, level, lived_in);
    if (!any) continue;
    for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y)
      for (std::int32_t group = x0; group <= x1; ++group) {
        if (lived_in[std::size_t((y >> 2) - y0) * width + std::size_t(group - x0)] == 0) continue;
        const std::int32_t begin = std::max(range.low[0], 4 * group),
                           end = std::min(range.high[0], 4 * group + 3);
        for (std::int32_t x = begin; x <= end; ++x) visit(cells_[place_of({x, y, z, level})], found);
      }
  }
}

}  // namespace lodestone
