// A body of `tables` that is near bodies of another rung: for a step it is moved among these, one by one
// (rungs/near_bodies.h).
#pragma once

#include "lod/tables/tables_model.h"

namespace lodestone {

struct Guest {
  std::int32_t slot = 0;  ///< in the tables level
  RestingRecord resting = {};
  bool touched = false;  ///< out: by a body of another rung; else it moves as if there were none
};

}  // namespace lodestone
