// Where bodies lie that sleep: cells in a hash table, so that one falls asleep or wakes without a look at the
// others. Bodies of other sizes have cells of other sizes, each edge twice the one before. Groups of cells
// tell at a few looks that nobody lies about a place; blocks, where they are kept instead, at one which cells
// are lived in.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "reference/geometry.h"
#include "reference/state_archive.h"

namespace lodestone {

class StillGrid {
 public:
  /// `with_blocks`: a search that finds nobody takes one look instead of one for each cell, for some 200 to
  /// 800 bytes more about each cell that is lived in by itself.
  explicit StillGrid(bool with_blocks = false) : with_blocks_(with_blocks) {}
  /// `body`: any small number, in the grid at most once. `radius` > 0, m.
  void insert(std::uint32_t body, const Vec3& position, double radius);
  /// With what it was inserted with.
  void remove(std::uint32_t body, const Vec3& position, double radius);
  bool empty() const { return bodies_ == 0; }
  void archive(StateArchive& a) {
    a(cells_, used_, bodies_, next_, of_level_);
    if (a.reading()) make_blocks(), count_groups(), find_levels();
  }
  std::size_t bytes() const {
    return cells_.capacity() * sizeof(Cell) + next_.capacity() * sizeof(std::uint32_t) +
           blocks_.capacity() * sizeof(Block) + groups_.capacity();
  }

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
  /// Four cells along each axis, of which one is lived in or was once. A block begins at every second cell,
  /// so that blocks overlap and any three cells in a row lie within one.
  struct Block {
    Key key{.level = kNoLevel};  // its number along each axis: it begins at the cell of twice that
    std::uint64_t lived_in = 0;  // a bit for each cell: x + 4 y + 16 z
  };
  static constexpr std::int32_t kNoLevel = -1000;
  static constexpr std::uint8_t kMany = 255;
  struct Range {
    std::array<std::int32_t, 3> low, high;
  };
  /// The bits of a block that lie in the range.
  static std::uint64_t bits_of(const Range& range, const Key& block) {
    const auto along_axis = [&](int axis, std::int32_t begin) {  // of four
      const std::int64_t low = std::max<std::int64_t>(0, std::int64_t(range.low[axis]) - begin),
                         high = std::min<std::int64_t>(3, std::int64_t(range.high[axis]) - begin);
      return low > high ? 0u : (0xfu >> (3 - high)) & (0xfu << low);
    };
    const std::uint64_t x = along_axis(0, 2 * block.x), y = along_axis(1, 2 * block.y),
                        z = along_axis(2, 2 * block.z);
    // A bit of y, or of z, is spread to where its row, or its plane, begins.
    const std::uint64_t rows = (y & 1) | (y & 2) << 3 | (y & 4) << 6 | (y & 8) << 9;
    const std::uint64_t planes = (z & 1) | (z & 2) << 15 | (z & 4) << 30 | (z & 8) << 45;
    return x * rows * planes;
  }
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
  std::size_t block_of(const Key& block) const;
  template <class Act>
  static void each_block(const Key& cell, const Act& act);
  void make_blocks();
  void grow_blocks();
  std::size_t group_of(const Key& cell) const;
  void count_groups();
  void find_levels();
  bool is_empty(const Range& range, std::int32_t level) const;
  void mark(const Key& cell);
  void unmark(const Key& cell);
  template <class Found>
  void visit_all(const Range& range, std::int32_t level, const Found& found) const;
  template <class Found>
  void visit_by_blocks(const Range& range, std::int32_t level, const Found& found) const;
  template <class Found>
  void visit(const Cell& cell, const Found& found) const {
    for (std::uint32_t body = cell.head; body != kNone; body = next_[body]) found(body);
  }

  std::vector<Cell> cells_;  // a power of two
  std::size_t used_ = 0, bodies_ = 0;
  std::vector<std::uint8_t> groups_;  // as many, by a group's hash: cells of it, and of others with that
                                      // hash, that are lived in; kMany for as many or more
  std::vector<std::uint32_t> next_;   // of each body, the next one in its cell
  std::array<std::uint32_t, 128> of_level_{};    // bodies
  int lowest_level_ = 64, highest_level_ = -64;  // that any body was ever of
  bool with_blocks_;
  std::vector<Block> blocks_;  // a power of two, or none
  std::size_t used_blocks_ = 0;
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
    if (with_blocks_)
      visit_by_blocks(range, level, found);
    else if (!is_empty(range, level))
      visit_all(range, level, found);
  }
}

// In the order of cells: x first, then y, then z.
template <class Found>
void StillGrid::visit_all(const Range& range, std::int32_t level, const Found& found) const {
  for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z)
    for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y)
      for (std::int32_t x = range.low[0]; x <= range.high[0]; ++x)
        visit(cells_[place_of({x, y, z, level})], found);
}

// In the same order.
template <class Found>
void StillGrid::visit_by_blocks(const Range& range, std::int32_t level, const Found& found) const {
  if (blocks_.empty()) return;
  const auto first_block = [](std::int32_t cell) {
    return cell >> 1;
  };  // the last one that begins there or before
  const Key first{first_block(range.low[0]), first_block(range.low[1]), first_block(range.low[2]), level};
  const auto within_one = [&](int axis, std::int32_t block) {
    return std::int64_t(range.high[axis]) - 2 * std::int64_t(block) <= 3;
  };
  if (within_one(0, first.x) && within_one(1, first.y) && within_one(2, first.z)) {
    for (std::uint64_t bits = blocks_[block_of(first)].lived_in & bits_of(range, first); bits != 0;
         bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      visit(
          cells_[place_of({2 * first.x + bit % 4, 2 * first.y + bit / 4 % 4, 2 * first.z + bit / 16, level})],
          found);
    }
    return;
  }
  bool any = false;
  for (std::int32_t z = first.z; 2 * std::int64_t(z) <= range.high[2] && !any; z += 2)
    for (std::int32_t y = first.y; 2 * std::int64_t(y) <= range.high[1] && !any; y += 2)
      for (std::int32_t x = first.x; 2 * std::int64_t(x) <= range.high[0] && !any; x += 2) {
        const Key block{x, y, z, level};
        any = (blocks_[block_of(block)].lived_in & bits_of(range, block)) != 0;
      }
  if (any) visit_all(range, level, found);
}

}  // namespace lodestone
