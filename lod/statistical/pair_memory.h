// Where each near pair of the last step is found again, by its two bodies.
#pragma once

#include <cstdint>
#include <vector>

namespace lodestone {

/// Which two bodies touch, by their owners, who stay the same while they do; a plane of the ground counts down from the greatest number.
using ContactKey = std::uint64_t;
inline ContactKey contact_key(std::uint32_t first, std::uint32_t second) { return ContactKey(first) << 32 | second; }
inline ContactKey ground_key(std::uint32_t body, std::size_t plane) { return contact_key(body, std::uint32_t(0xffffffff - plane)); }

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
