// A body of `tables` that is near bodies of another rung, or at an edge of the ground: for a step it is moved
// as those of `support` are, one by one (rungs/near_bodies.h).
#pragma once

#include "lod/tables/tables_model.h"

namespace lodestone {

struct Guest {
  std::int32_t slot = 0;  ///< in the tables level
  RestingRecord resting = {};
  bool on_hull =
      false;           ///< meets the ground on its hull, as it touches none of its own rung; else as a sphere
  bool moved = false;  ///< out: else it moves as if it had not been here
  bool carried = false;  ///< out: by what nothing stops (rungs/carried_bodies.h)
  bool touched = false;  ///< out: by a body of another rung, or, a sphere, by several parts of the ground
};

}  // namespace lodestone
