// Promotions to the full level that were put off, since the body overlaps another or the ground: they are
// tried again after 8 frames, then 16, … 128, as bodies that overlap must not use up every frame's changes.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "reference/state_archive.h"

namespace lodestone {

class PutOffPromotions {
 public:
  /// `body`: the manager's index.
  void put_off(std::uint32_t body);
  /// A frame is over; returns those that may be tried again now.
  std::vector<std::uint32_t> count_down();
  /// It is full, or gone.
  void forget(std::uint32_t body) { waits_.erase(body); }
  /// Those whose time has not come, in no order.
  std::vector<std::uint32_t> waiting() const;
  void archive(StateArchive& a) { a(waits_); }

 private:
  struct Wait {
    int frames_left = 0, frames = 0;  // of the whole wait
  };
  std::unordered_map<std::uint32_t, Wait>
      waits_;  // with those that were tried again, and may be put off anew
};

}  // namespace lodestone
