// A plane, box, mesh or other piece of ground of a Manager.
#pragma once

#include <cstdint>

namespace lodestone {

/// Stable until it is removed; a removed one's id is never valid again. Zero is null.
struct GroundId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(GroundId, GroundId) = default;
};

}  // namespace lodestone
