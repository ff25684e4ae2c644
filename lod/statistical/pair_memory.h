// What the last step knew of near pairs: the axis that separated them, and their gap. A gap lasts until the two bodies have travelled it, so
// most near pairs need no look at their hulls (conservative advancement; Mirtich, 1996), and the others begin at a good axis.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/statistical/contact_memory.h"
#include "reference/geometry.h"

namespace lodestone {

struct PairRecord {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< from the second body to the first
  float gap = 0.0f;                                   ///< m along it, at least, when it was found
  double travel = 0.0;                                ///< m, of both bodies together, when it was found
};

/// A hash table of the last step's pairs, read while the next one is filled.
class PairMemory {
 public:
  /// Null where the pair was not near in the last step.
  const PairRecord* find(ContactKey key) const;
  void begin(std::size_t pairs);                       ///< of a step with so many pairs
  void put(ContactKey key, const PairRecord& record);  ///< for the next step; each key once
  void end();                                          ///< from now on `find` looks at what was put

 private:
  struct Entry {
    ContactKey key = kEmpty;
    PairRecord record;
  };
  static constexpr ContactKey kEmpty = ~ContactKey(0);
  static std::size_t place_of(ContactKey key, std::size_t mask);
  std::vector<Entry> known_, next_;
};

}  // namespace lodestone
