// Which things hang together, directly or through others (Galler and Fisher, An improved equivalence
// algorithm, 1964; paths are halved as in Tarjan and van Leeuwen, Worst-case analysis of set union
// algorithms, 1984).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodestone {

class DisjointSets {
 public:
  /// 0 … count − 1; what is new is in no set until set_apart().
  void make_room(std::size_t count) { parent_.resize(count); }
  /// Each of 0 … count − 1 is a set.
  void set_all_apart(std::size_t count) {
    make_room(count);
    for (std::size_t i = 0; i < count; ++i) set_apart(std::int32_t(i));
  }
  void set_apart(std::int32_t i) { parent_[std::size_t(i)] = i; }
  void join(std::int32_t a, std::int32_t b) { parent_[std::size_t(root_of(a))] = root_of(b); }
  /// The one of the set of `i` that stands for it.
  std::int32_t root_of(std::int32_t i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }

 private:
  std::vector<std::int32_t> parent_;  // of each: another of its set, or itself
};

}  // namespace lodestone
