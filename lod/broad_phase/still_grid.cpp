#include "lod/broad_phase/still_grid.h"

#include <algorithm>

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
  Cell& cell = cells_[place_of(key_of(position, level))];
  if (!cell.used) {
    cell = {key_of(position, level), kNone, true};
    ++used_;
  }
  if (body >= next_.size()) next_.resize(body + 1, kNone);
  if (cell.head == kNone) mark(cell.key);
  next_[body] = cell.head;
  cell.head = body;
  ++bodies_;
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

// A group is four cells wide along each axis.
std::size_t StillGrid::group_of(const Key& cell) const {
  return hash_of({cell.x >> 2, cell.y >> 2, cell.z >> 2, cell.level}) & (groups_.size() - 1);
}

// Anew, from the cells.
void StillGrid::count_groups() {
  groups_.assign(with_blocks_ ? 0 : cells_.size(), 0);
  if (with_blocks_) return;
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

bool StillGrid::is_empty(const Range& range, std::int32_t level) const {
  for (std::int32_t z = range.low[2] >> 2; z <= range.high[2] >> 2; ++z)
    for (std::int32_t y = range.low[1] >> 2; y <= range.high[1] >> 2; ++y)
      for (std::int32_t x = range.low[0] >> 2; x <= range.high[0] >> 2; ++x)
        if (groups_[group_of({4 * x, 4 * y, 4 * z, level})] != 0) return false;
  return true;
}

std::size_t StillGrid::block_of(const Key& block) const {
  const std::size_t mask = blocks_.size() - 1;
  std::size_t place = hash_of(block) & mask;
  while (blocks_[place].key.level != kNoLevel && blocks_[place].key != block) place = (place + 1) & mask;
  return place;
}

// Calls act(block, bit) for the eight blocks that the cell lies in, and its bit there.
template <class Act>
void StillGrid::each_block(const Key& cell, const Act& act) {
  for (int corner = 0; corner < 8; ++corner) {
    const Key block{(cell.x >> 1) - (corner & 1), (cell.y >> 1) - (corner >> 1 & 1),
                    (cell.z >> 1) - (corner >> 2), cell.level};
    act(block, std::uint64_t(1) << ((cell.x - 2 * block.x) + 4 * (cell.y - 2 * block.y) +
                                    16 * (cell.z - 2 * block.z)));
  }
}

void StillGrid::mark(const Key& cell) {
  if (!with_blocks_) {
    std::uint8_t& count = groups_[group_of(cell)];
    if (count < kMany) ++count;
    return;
  }
  if (2 * (used_blocks_ + 8) > blocks_.size()) grow_blocks();
  each_block(cell, [this](const Key& key, std::uint64_t bit) {
    Block& block = blocks_[block_of(key)];
    if (block.key.level == kNoLevel) block.key = key, ++used_blocks_;
    block.lived_in |= bit;
  });
}

void StillGrid::unmark(const Key& cell) {
  if (with_blocks_)
    return each_block(cell,
                      [this](const Key& key, std::uint64_t bit) { blocks_[block_of(key)].lived_in &= ~bit; });
  std::uint8_t& count = groups_[group_of(cell)];
  if (count < kMany) --count;
}

// Blocks in which nobody lies any more are left out.
void StillGrid::grow_blocks() {
  std::vector<Block> old = std::move(blocks_);
  used_blocks_ =
      std::size_t(std::ranges::count_if(old, [](const Block& block) { return block.lived_in != 0; }));
  blocks_.assign(std::bit_ceil(std::max<std::size_t>(64, 3 * (used_blocks_ + 8))), {});
  for (const Block& block : old)
    if (block.lived_in != 0) blocks_[block_of(block.key)] = block;
}

// Anew, from the cells.
void StillGrid::make_blocks() {
  blocks_.clear();
  used_blocks_ = 0;
  if (!with_blocks_) return;
  for (const Cell& cell : cells_)
    if (cell.head != kNone) mark(cell.key);
}

}  // namespace lodestone
