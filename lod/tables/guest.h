// A body of `tables` that is near bodies of another rung, or at an edge of the ground. For a step it is moved
// one by one, as bodies of `support` are (rungs/near_bodies.h).
#pragma once

#include "lod/tables/tables_model.h"

namespace lodestone {

struct Guest {
  std::int32_t slot = 0;  ///< in the tables level
  RestingRecord resting = {};
  /// Meets the ground with its hull, since it touches no body of its own rung; else with its sphere.
  bool on_hull = false;
  bool moved = false;    ///< out: it was moved here; else it moves as if it had been no guest
  bool carried = false;  ///< out: by what nothing stops (rungs/carried_bodies.h)
  bool touched =
      false;  ///< out: by another rung's body, or, if it is a sphere, by several parts of the ground
};

}  // namespace lodestone
