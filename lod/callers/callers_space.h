// What the statistical rungs meet of a caller's own space.
#pragma once

#include "lod/callers/callers_bodies.h"
#include "lod/callers/callers_ground.h"

namespace lodestone {

struct CallersSpace {
  explicit CallersSpace(Ground& around) : ground(around) {}
  CallersGround ground;
  CallersBodies bodies;
};

}  // namespace lodestone
