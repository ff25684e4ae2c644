#include "lod/statistical/pair_memory.h"

#include <algorithm>
#include <bit>

namespace lodestone {

std::size_t PairMemory::place_of(ContactKey key, std::size_t mask) { return std::size_t((key * 0x9e3779b97f4a7c15u) >> 20) & mask; }

const PairRecord* PairMemory::find(ContactKey key) const {
  if (known_.empty()) return nullptr;
  const std::size_t mask = known_.size() - 1;
  for (std::size_t i = place_of(key, mask); known_[i].key != kEmpty; i = (i + 1) & mask)
    if (known_[i].key == key) return &known_[i].record;
  return nullptr;
}

void PairMemory::begin(std::size_t pairs) { next_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * pairs)), Entry{}); }

void PairMemory::put(ContactKey key, const PairRecord& record) {
  const std::size_t mask = next_.size() - 1;
  std::size_t i = place_of(key, mask);
  while (next_[i].key != kEmpty) i = (i + 1) & mask;
  next_[i] = {key, record};
}

void PairMemory::end() { std::swap(known_, next_); }

}  // namespace lodestone
