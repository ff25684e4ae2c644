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
/// One of several between the same two, by its number.
inline ContactKey numbered_key(ContactKey key, std::uint32_t number) {
  return key ^
         number * 0x9e3779b97f4a7c15u;  // 2⁶⁴ over the golden ratio: far from each other and from others
}

class PairMemory {
 public:
  void clear();
  void archive(StateArchive& a) {
    a(keys_);
    if (a.reading()) mark_anew();
  }
  void add(ContactKey key) {
    keys_.push_back(key);
    mark(key);
    made_ = false;
  }
  void add(const PairMemory& others) {
    for (const ContactKey key : others.keys_) add(key);
  }
  /// The place at which `key` was added, the first one; −1: never. Quick where that is about `expected`:
  /// lists mostly keep their order from step to step.
  std::int32_t find(ContactKey key, std::size_t expected);

 private:
  static constexpr std::size_t kLeastMarks = 16;  // words
  // Two bits of `marks_`.
  struct Marks {
    std::size_t one, other;
  };
  // Each bit of it hangs on both bodies: what lies on the ground has one second for all (the finalizer of
  // SplitMix64; Steele, Lea and Flood, Fast splittable pseudorandom number generators, 2014).
  static std::uint64_t hash_of(ContactKey key) {
    key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
    key = (key ^ key >> 27) * 0x94d049bb133111ebu;
    return key ^ key >> 31;
  }
  Marks marks_of(ContactKey key) const {
    const std::uint64_t hash = hash_of(key), bits = 64 * marks_.size();
    return {std::size_t(hash & (bits - 1)), std::size_t(hash >> 32 & (bits - 1))};
  }
  bool is_marked(std::size_t bit) const { return (marks_[bit / 64] >> bit % 64 & 1) != 0; }
  void mark(ContactKey key) {
    for (const auto [one, other] = marks_of(key); const std::size_t bit : {one, other})
      marks_[bit / 64] |= std::uint64_t(1) << bit % 64;
  }
  void clear_marks(std::size_t keys);
  void mark_anew();
  std::size_t entry_of(ContactKey key) const;
  void make_table();

  std::vector<ContactKey> keys_;
  // Whose bits are not set is not among the keys: most that are new show so, without a table (Bloom,
  // Space/time trade-offs in hash coding with allowable errors, 1970). A power of two of words.
  std::vector<std::uint64_t> marks_ = std::vector<std::uint64_t>(kLeastMarks, 0);
  // Places by their keys' hashes, −1: none; a power of two of them, made when first needed.
  std::vector<std::int32_t> table_;
  bool made_ = false;
};

}  // namespace lodestone
