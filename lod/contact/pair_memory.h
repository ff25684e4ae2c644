// Where each pair of bodies was in a list of the last step.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/state_archive.h"

namespace lodestone {

/// Which two bodies touch, by their owners, who stay the same while they do; a plane of the ground counts
/// down from the greatest number.
using ContactKey = std::uint64_t;
inline ContactKey contact_key(std::uint32_t first, std::uint32_t second) {
  return ContactKey(first) << 32 | second;
}
inline ContactKey ground_key(std::uint32_t body, std::size_t plane) {
  return contact_key(body, std::uint32_t(0xffffffff - plane));
}

class PairMemory {
 public:
  void clear();
  void archive(StateArchive& a) {
    a(keys_);
    made_ = made_ && !a.reading();
  }
  void add(ContactKey key) { keys_.push_back(key); }
  /// The place at which `key` was added, the first one; −1: never. Quick where that is about `expected`:
  /// lists mostly keep their order from step to step.
  std::int32_t find(ContactKey key, std::size_t expected);

 private:
  std::size_t entry_of(ContactKey key) const;
  void make_table();

  std::vector<ContactKey> keys_;
  // Places by their keys' hashes, −1: none; a power of two of them, made when first needed.
  std::vector<std::int32_t> table_;
  bool made_ = false;
};

}  // namespace lodestone
