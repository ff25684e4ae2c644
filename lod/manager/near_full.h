// Where the full bodies are, for as long as they stay there: made once it is asked for, so that taking many
// bodies out between two steps does not look at all of them each time.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/broad_phase/still_grid.h"

namespace lodestone {

class NearFull {
 public:
  bool made() const { return made_; }
  /// What was noted holds no more.
  void clear() {
    if (made_) *this = {};
  }
  void begin() { made_ = true; }
  /// `body`: the manager's index; again where it was moved. `reach` in m.
  void add(std::uint32_t body, const Vec3& position, double reach) {
    grid_.insert(std::uint32_t(bodies_.size()), position, reach);
    bodies_.push_back(body);
  }
  /// Calls found(body) for those whose reach may meet this one, for some beyond, and for some that are gone,
  /// perhaps twice.
  template <class Found>
  void find(const Vec3& center, double reach, const Found& found) const {
    grid_.find_near(center, reach, [&](std::uint32_t entry) { found(bodies_[entry]); });
  }

 private:
  bool made_ = false;
  StillGrid grid_;                     // of entries
  std::vector<std::uint32_t> bodies_;  // of each entry
};

}  // namespace lodestone
