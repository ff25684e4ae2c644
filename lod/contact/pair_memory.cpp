#include "lod/contact/pair_memory.h"

#include <algorithm>
#include <bit>

namespace lodestone {

void PairMemory::clear() {
  clear_marks(keys_.size());
  keys_.clear();
  made_ = false;
}

// Room for about so many keys, or for half as many as there was room for: one that was empty may fill again.
void PairMemory::clear_marks(std::size_t keys) {
  constexpr std::size_t kBitsOfKey = 32;
  marks_.assign(std::bit_ceil(std::max({kLeastMarks, keys * kBitsOfKey / 64, marks_.size() / 2})), 0);
}

void PairMemory::mark_anew() {
  clear_marks(keys_.size());
  for (const ContactKey key : keys_) mark(key);
  made_ = false;
}

std::int32_t PairMemory::find(ContactKey key, std::size_t expected) {
  constexpr std::size_t kBefore = 2, kAfter = 6;
  const std::size_t end = std::min(keys_.size(), expected + kAfter);
  for (std::size_t i = expected > kBefore ? expected - kBefore : 0; i < end; ++i)
    if (keys_[i] == key) return std::int32_t(i);
  if (const auto [one, other] = marks_of(key); !is_marked(one) || !is_marked(other)) return -1;
  if (!made_) make_table();
  return table_[entry_of(key)];
}

// Where the key is, or the free entry in which it would be.
std::size_t PairMemory::entry_of(ContactKey key) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = std::size_t(hash_of(key)) & mask;
  while (table_[i] >= 0 && keys_[std::size_t(table_[i])] != key) i = (i + 1) & mask;
  return i;
}

void PairMemory::make_table() {
  table_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * keys_.size())), -1);
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (std::int32_t& place = table_[entry_of(keys_[i])]; place < 0) place = std::int32_t(i);
  made_ = true;
}

}  // namespace lodestone
