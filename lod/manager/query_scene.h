// All bodies where they are now, for queries: nothing is kept of them until somebody asks, and from then on a
// step costs in proportion to those that moved.
#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "lod/manager/levels.h"
#include "lod/manager/query_callers.h"
#include "lod/manager/query_ground.h"
#include "lod/queries/body_grid.h"

namespace lodestone {

class QueryScene {
 public:
  explicit QueryScene(const Levels& levels)
      : levels_(levels), ground_(levels.ground, levels.callers.ground) {}

  /// Something moved, came or went.
  void touch() { stale_ = true; }
  /// Until finish() bodies move that nobody tells of.
  void begin_callers_step() { stale_ = under_way_ = true; }
  void forget(std::uint32_t body) { grid_.forget(body), stale_ = true; }
  /// Where it is now it was laid to sleep.
  void lay_down(std::uint32_t body);
  /// A step is over in which these moved that sleep now.
  void finish(std::span<const BodyId> fell_asleep, std::span<const BodyId> moved_and_slept);
  /// All may be elsewhere.
  void forget_all() { grid_.clear(), slept_.clear(), in_use_ = false, stale_ = true; }

  /// What some questions are asked of. The caller's bodies may go any time, so it is made anew for each call.
  struct Asked {
    QueryFilter filter;
    std::vector<CallersPart> callers;
  };
  /// For who reads the ground meanwhile.
  std::unique_lock<std::mutex> hold_ground() { return ground_.hold(); }
  /// Before any number of questions.
  Asked prepare(const QueryFilter& filter);
  // From any thread. Lists are appended to.
  std::optional<QueryHit> first(const Sweep& sweep, const Asked& asked);
  void all(const Sweep& sweep, const Asked& asked, std::vector<QueryHit>& hits);
  void overlaps(const Volume& volume, const Asked& asked, std::vector<QueryHit>& hits);

 private:
  void update_grid();
  bool passes(std::uint32_t body, const QueryFilter& filter) const;
  PosedSurface surface_of(std::uint32_t body, const Vec3& position, const Quat& orientation);
  std::optional<QueryHit> meet_body(std::uint32_t body, const Sweep& sweep);
  std::optional<QueryHit> overlap_body(std::uint32_t body, const Volume& volume);
  void put(std::uint32_t body);

  const Levels& levels_;
  QueryGround ground_;
  QueryCallers callers_;
  ShapeTrees trees_;
  BodyGrid grid_;
  bool in_use_ = false, stale_ = true, under_way_ = false;
  std::vector<std::uint32_t> slept_;  // fell asleep since the grid was last brought up to date
  std::mutex access_;
};

}  // namespace lodestone
