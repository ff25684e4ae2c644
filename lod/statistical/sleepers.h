// The one store of bodies that sleep: in no loop, found by where they lie. Each rung calls its own by their
// slots there.
#pragma once

#include <array>

#include "lod/body.h"
#include "lod/broad_phase/still_grid.h"
#include "reference/state_archive.h"

namespace lodestone {

class Sleepers {
 public:
  StillGrid& of(StatisticalModel model) { return grids_[std::size_t(model)]; }
  const StillGrid& of(StatisticalModel model) const { return grids_[std::size_t(model)]; }
  bool empty() const { return grids_[0].empty() && grids_[1].empty(); }
  std::uint64_t insertions() const { return grids_[0].insertions() + grids_[1].insertions(); }
  void archive(StateArchive& a) { a(grids_[0], grids_[1]); }
  std::size_t bytes() const { return grids_[0].bytes() + grids_[1].bytes(); }

  /// Calls found(model, slot) for those whose ball may meet this one, and for some a cell beyond.
  template <class Found>
  void find_near(const Vec3& center, double reach, const Found& found) const {
    for (const StatisticalModel model : {StatisticalModel::tables, StatisticalModel::support})
      of(model).find_near(center, reach, [&](std::uint32_t slot) { found(model, std::int32_t(slot)); });
  }

 private:
  // Of `support` with blocks: its bodies ask for sleepers one by one. Spheres ask rarely, and have no bytes
  // to spare.
  std::array<StillGrid, 2> grids_;
  static_assert(std::size_t(StatisticalModel::support) == 1);
};

}  // namespace lodestone
