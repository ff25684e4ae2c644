#include "lod/statistical/pair_memory.h"

#include <algorithm>
#include <bit>

namespace lodestone {

std::int32_t PairMemory::find(ContactKey key) const {
  if (known_.empty()) return -1;
  std::size_t i = place_of(key);
  while (known_[i].key != kEmpty && known_[i].key != key) i = (i + 1) & (known_.size() - 1);
  return known_[i].place;
}

void PairMemory::begin(std::size_t pairs) { known_.assign(std::bit_ceil(std::max<std::size_t>(16, 2 * pairs)), Entry{}); }

void PairMemory::put(ContactKey key, std::int32_t place) {
  std::size_t i = place_of(key);
  while (known_[i].key != kEmpty) i = (i + 1) & (known_.size() - 1);
  known_[i] = {key, place};
}

}  // namespace lodestone
