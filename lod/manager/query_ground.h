// The ground as queries meet it: planes, and solids by their surfaces.
#pragma once

#include <functional>
#include <mutex>
#include <vector>

#include "lod/callers/callers_ground.h"
#include "lod/manager/query_surfaces.h"
#include "lod/queries.h"

namespace lodestone {

class QueryGround {
 public:
  QueryGround(const Ground& ground, const CallersGround& callers) : ground_(ground), callers_(callers) {}

  using Found = std::function<void(const QueryHit&)>;
  // Each part at most once, at its first point; the ray of a sweep may become shorter meanwhile. From any
  // thread.
  void meet(const Sweep& sweep, const Found& found);
  void overlap(const Volume& volume, const Found& found);
  /// While it lasts no question makes solids of the ground.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(access_); }

 private:
  ContactSide side_of(GroundId id, MaterialId material) const;
  QueryHit hit_of(const GroundPart& part, const SurfaceHit& hit) const;

  const Ground& ground_;
  const CallersGround& callers_;
  SolidQueries solids_;
  std::mutex access_;  // to the ground, which makes solids as it is asked for them
};

}  // namespace lodestone
