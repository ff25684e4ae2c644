// The impulses of the last step's contacts, from which the solver starts: a pile at rest is then solved almost before the first sweep
// (warm starting; Catto, Iterative dynamics with temporal coherence, 2005).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/statistical/contact_solver.h"

namespace lodestone {

/// Which two bodies touch, by their owners, who stay the same while they do; a plane of the ground counts down from the greatest number.
using ContactKey = std::uint64_t;
inline ContactKey contact_key(std::uint32_t first, std::uint32_t second) { return ContactKey(first) << 32 | second; }
inline ContactKey ground_key(std::uint32_t body, std::size_t plane) { return contact_key(body, std::uint32_t(0xffffffff - plane)); }

class ContactMemory {
 public:
  /// Sets `guess` of the contacts of a pair to what they had: point by point, or where their number changed, in equal parts. `keys` holds one
  /// key per contact, equal ones in a row; `step` is the length of this step, s.
  void recall(std::span<const ContactKey> keys, std::span<SolverContact> contacts, double step) const;
  /// Forgets what was before.
  void remember(std::span<const ContactKey> keys, std::span<const SolverContact> contacts, double step);

 private:
  struct Run {
    ContactKey key;
    std::uint32_t begin, count;
  };
  std::vector<Run> runs_;       // in order of keys
  std::vector<Vec3> forces_;    // N, on the first body
};

}  // namespace lodestone
