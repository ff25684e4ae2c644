// Where each near pair of the last step is found again, by its two bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/statistical/contact_memory.h"

namespace lodestone {

/// A hash table of keys, each once.
class PairMemory {
 public:
  /// −1 where the pair was not put.
  std::int32_t find(ContactKey key) const;
  void begin(std::size_t pairs);  ///< forgets all, for so many
  void put(ContactKey key, std::int32_t place);

 private:
  struct Entry {
    ContactKey key = kEmpty;
    std::int32_t place = -1;
  };
  static constexpr ContactKey kEmpty = ~ContactKey(0);
  std::size_t place_of(ContactKey key) const { return std::size_t((key * 0x9e3779b97f4a7c15u) >> 20) & (known_.size() - 1); }
  std::vector<Entry> known_;  // a power of two of them
};

}  // namespace lodestone
