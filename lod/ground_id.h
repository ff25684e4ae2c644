// The id of a piece of a Manager's ground: a plane, a box, a mesh.
#pragma once

#include <cstdint>

namespace lodestone {

/// Names a piece of ground until that is removed; after that the id is never valid again. Zero is null.
struct GroundId {
  std::uint32_t index = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  friend bool operator==(GroundId, GroundId) = default;
};

}  // namespace lodestone
