// The caller's dynamic bodies as queries meet them: by the solids of their geoms, where these are when it is
// asked.
#pragma once

#include <span>

#include "lod/callers/callers_bodies.h"
#include "lod/manager/query_ground.h"

namespace lodestone {

class QueryCallers {
 public:
  // Each geom at most once, at its first point; the ray of a sweep may become shorter meanwhile. From any
  // thread.
  using Found = QueryGround::Found;
  void meet(std::span<const CallersPart> parts, unsigned categories, const Sweep& sweep, const Found& found);
  void overlap(std::span<const CallersPart> parts, unsigned categories, const Volume& volume,
               const Found& found);

 private:
  SolidQueries solids_;
};

}  // namespace lodestone
