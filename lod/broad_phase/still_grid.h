// Where bodies lie that sleep: cells in a hash table, so that one falls asleep or wakes without a look at the others. Bodies of other sizes have cells of other
// sizes, each edge twice the one before.
#pragma once

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
  /// `body`: any small number, in the grid at most once. `radius` > 0, m.
  void insert(std::uint32_t body, const Vec3& position, double radius);
  /// With what it was inserted with.
  void remove(std::uint32_t body, const Vec3& position, double radius);
  bool empty() const { return bodies_ == 0; }
  void archive(StateArchive& a) { a(cells_, used_, bodies_, next_, of_level_); }
  std::size_t bytes() const { return cells_.capacity() * sizeof(Cell) + next_.capacity() * sizeof(std::uint32_t); }

  /// Calls found(body) for every body whose ball may meet this one, and for some a cell beyond, in an order that follows from what was inserted and removed.
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
  static int level_of(double radius) { return std::ilogb(2.0 * radius) + 1; }
  static double edge_of(int level) { return std::ldexp(1.0, level); }
  static std::int32_t along(double at) { return std::int32_t(std::floor(std::fmin(std::fmax(at, -2e9), 2e9))); }
  static Key key_of(const Vec3& position, int level);
  std::size_t place_of(const Key& key) const;
  void grow();
  template <class Found>
  void visit(const Cell& cell, const Found& found) const {
    for (std::uint32_t body = cell.head; body != kNone; body = next_[body]) found(body);
  }

  std::vector<Cell> cells_;                 // a power of two
  std::size_t used_ = 0, bodies_ = 0;
  std::vector<std::uint32_t> next_;         // of each body, the next one in its cell
  std::array<std::uint32_t, 128> of_level_{};  // bodies
};

template <class Found>
void StillGrid::find_near(const Vec3& center, double reach, const Found& found) const {
  if (empty()) return;
  for (int index = 0; index < int(of_level_.size()); ++index) {
    if (of_level_[index] == 0) continue;
    const int level = index - 64;
    const double inverse = 1.0 / edge_of(level), span = reach + 0.5 * edge_of(level);
    const Vec3 low = (center - Vec3::Constant(span)) * inverse, high = (center + Vec3::Constant(span)) * inverse;
    const double cells = (high - low + Vec3::Constant(2.0)).prod();
    if (cells > 2.0 * double(cells_.size())) {  // larger than the whole table
      for (const Cell& cell : cells_)
        if (cell.key.level == level) visit(cell, found);
      continue;
    }
    for (std::int32_t z = along(low.z()); z <= along(high.z()); ++z)
      for (std::int32_t y = along(low.y()); y <= along(high.y()); ++y)
        for (std::int32_t x = along(low.x()); x <= along(high.x()); ++x) visit(cells_[place_of({x, y, z, level})], found);
  }
}

}  // namespace lodestone
