#include "lod/broad_phase/still_grid.h"

#include <algorithm>
#include <bit>

#include "reference/error.h"

namespace lodestone {

StillGrid::Key StillGrid::key_of(const Vec3& position, int level) {
  const double inverse = 1.0 / edge_of(level);
  return {along(position.x() * inverse), along(position.y() * inverse), along(position.z() * inverse), level};
}

std::size_t StillGrid::hash_of(const Key& key) {
  std::uint64_t hash = std::uint64_t(std::uint32_t(key.x)) * 0x9e3779b97f4a7c15u;
  hash = (hash ^ (hash >> 29) ^ std::uint32_t(key.y)) * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 32) ^ std::uint32_t(key.z)) * 0x94d049bb133111ebu;
  hash ^= (hash >> 31) ^ (std::uint64_t(std::uint32_t(key.level)) << 7);
  return std::size_t(hash);
}

// Where the key is, or the free place in which it would be.
std::size_t StillGrid::place_of(const Key& key) const {
  const std::size_t mask = cells_.size() - 1;
  std::size_t place = hash_of(key) & mask;
  while (cells_[place].used && cells_[place].key != key) place = (place + 1) & mask;
  return place;
}

void StillGrid::insert(std::uint32_t body, const Vec3& position, double radius) {
  if (2 * (used_ + 1) > cells_.size()) grow();
  const int level = level_of(radius);
  announce(position, radius, level);
  Cell& cell = cells_[place_of(key_of(position, level))];
  if (!cell.used) {
    cell = {key_of(position, level), kNone, true};
    ++used_;
  }
  if (body >= next_.size()) next_.resize(body + 1, kNone);
  if (cell.head == kNone) mark(cell.key);
  next_[body] = cell.head;
  cell.head = body;
  ++bodies_, ++insertions_;
  ++of_level_[level + 64];
  lowest_level_ = std::min(lowest_level_, level);
  highest_level_ = std::max(highest_level_, level);
}

void StillGrid::remove(std::uint32_t body, const Vec3& position, double radius) {
  const int level = level_of(radius);
  Cell& cell = cells_[place_of(key_of(position, level))];
  std::uint32_t* link = &cell.head;
  while (*link != body) {
    check_that(*link != kNone, "the body is where it was inserted");
    link = &next_[*link];
  }
  *link = next_[body];
  if (cell.head == kNone) unmark(cell.key);
  --bodies_;
  --of_level_[level + 64];
}

void StillGrid::announce(const Vec3& position, double radius, int level) {
  constexpr double kDrawn = 1.05;
  arrivals_.resize(kRegions, 0);
  const double inverse = 1.0 / edge_of_region(level), way = kDrawn * radius + 0.5 * edge_of_region(level);
  const Vec3 low = (position - Vec3::Constant(way)) * inverse,
             high = (position + Vec3::Constant(way)) * inverse;
  for (std::int32_t z = along(low.z()); z <= along(high.z()); ++z)
    for (std::int32_t y = along(low.y()); y <= along(high.y()); ++y)
      for (std::int32_t x = along(low.x()); x <= along(high.x()); ++x)
        ++arrivals_[place_of_region({x, y, z, level})];
}

std::optional<std::uint64_t> StillGrid::arrivals_near(const Vec3& center, double reach) const {
  std::uint64_t sum = readings_ << 48;
  if (arrivals_.empty()) return sum;
  for (int level = lowest_level_; level <= highest_level_; ++level) {
    const double edge = edge_of_region(level);
    if (reach > 0.5 * edge) return {};
    const Vec3 at = center * (1.0 / edge);
    sum += arrivals_[place_of_region({along(at.x()), along(at.y()), along(at.z()), level})];
  }
  return sum;
}

bool StillGrid::find_lived_in(std::int32_t x0, std::int32_t x1, std::int32_t y0, std::int32_t y1,
                              std::int32_t z, std::int32_t level, std::vector<std::uint8_t>& lived_in) const {
  lived_in.clear();
  bool any = false;
  for (std::int32_t y = y0; y <= y1; ++y)
    for (std::int32_t x = x0; x <= x1; ++x) {
      lived_in.push_back(groups_[place_of_group({x, y, z, level})]);
      any |= lived_in.back() != 0;
    }
  return any;
}

// Cells that nobody lies in any more are left out.
void StillGrid::grow() {
  std::vector<Cell> old = std::move(cells_);
  const auto lived_in =
      std::size_t(std::ranges::count_if(old, [](const Cell& cell) { return cell.head != kNone; }));
  cells_.assign(std::bit_ceil(std::max<std::size_t>(64, 4 * (lived_in + 1))), {});
  used_ = lived_in;
  for (const Cell& cell : old)
    if (cell.head != kNone) cells_[place_of(cell.key)] = cell;
  count_groups();
}

// Anew, from the cells.
void StillGrid::count_groups() {
  groups_.assign(kGroups * cells_.size(), 0);
  for (const Cell& cell : cells_)
    if (cell.head != kNone) mark(cell.key);
}

void StillGrid::find_levels() {
  lowest_level_ = 64, highest_level_ = -64;
  for (int level = -64; level < 64; ++level) {
    if (of_level_[std::size_t(level + 64)] == 0) continue;
    lowest_level_ = std::min(lowest_level_, level);
    highest_level_ = level;
  }
}

void StillGrid::mark(const Key& cell) {
  std::uint8_t& count = groups_[place_of_group(group_of(cell))];
  if (count < kMany) ++count;
}

void StillGrid::unmark(const Key& cell) {
  std::uint8_t& count = groups_[place_of_group(group_of(cell))];
  if (count < kMany) --count;
}

}  // namespace lodestone
