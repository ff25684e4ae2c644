// Which bodies may touch another in this step: marks by index that cost nothing for those that sleep.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/participant.h"

namespace lodestone {

class NearMarks {
 public:
  void begin(std::size_t bodies) {
    for (const std::int32_t index : marked_) marks_[std::size_t(index)] = 0;
    marked_.clear();
    make_room(bodies);
  }
  void make_room(std::size_t bodies) { marks_.resize(std::max(marks_.size(), bodies), 0); }
  void mark(Participant p) {
    if (!p.is_statistical() || marks_[p.index()]) return;
    marks_[p.index()] = 1;
    marked_.push_back(std::int32_t(p.index()));
  }
  bool operator[](std::size_t index) const { return marks_[index] != 0; }
  std::span<const std::int32_t> marked() const { return marked_; }  ///< indices, in no order

 private:
  std::vector<char> marks_;
  std::vector<std::int32_t> marked_;
};

}  // namespace lodestone
