// Which bodies may touch another in this step, and at which pace each of them moves: marks by index that cost
// nothing for those that sleep.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/participant.h"

namespace lodestone {

/// In how many substeps of a step a body moves, with all that it may touch; 0: it may touch none.
using Pace = std::uint8_t;
/// Whether its substeps are so long that bodies turn and fall on their way by more than what counts as
/// touching.
inline bool is_long(Pace pace) { return pace < 3; }

class NearMarks {
 public:
  static constexpr Pace kUnplanned = 255;

  void begin(std::size_t bodies) {
    for (const std::int32_t index : marked_) paces_[std::size_t(index)] = 0;
    marked_.clear();
    full_pace_ = 0;
    make_room(bodies);
  }
  void make_room(std::size_t bodies) { paces_.resize(std::max(paces_.size(), bodies), 0); }
  /// Its pace is planned later, if it has none.
  void mark(Participant p) {
    if (p.is_statistical() && paces_[p.index()] == 0) set_pace(p, kUnplanned);
  }
  bool operator[](std::size_t index) const { return paces_[index] != 0; }
  std::span<const std::int32_t> marked() const { return marked_; }  ///< indices, in no order

  /// Of a statistical body.
  void set_pace(Participant p, Pace pace) {
    if (paces_[p.index()] == 0) marked_.push_back(std::int32_t(p.index()));
    paces_[p.index()] = pace;
  }
  /// Of all full bodies.
  void set_full_pace(Pace pace) { full_pace_ = pace; }
  Pace full_pace() const { return full_pace_; }
  Pace pace(Participant p) const { return p.is_full() ? full_pace_ : paces_[p.index()]; }

 private:
  std::vector<Pace> paces_;
  Pace full_pace_ = 0;
  std::vector<std::int32_t> marked_;
};

}  // namespace lodestone
