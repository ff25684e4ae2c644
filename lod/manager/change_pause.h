// How long none goes up after a budget sent some back down whose last change was not long ago. Who goes up in
// a heap moves those around it, and what these then cost may be more than the budget has: so bodies go down
// again, all fall asleep, there is room once more, and so on for ever. Therefore, while the viewpoints stay,
// each time that some had to go back the others wait twice as long as the time before. Only where many sleep
// already: else there is nothing that would come to rest for it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reference/state_archive.h"

namespace lodestone {

class ChangePause {
 public:
  static constexpr std::int32_t kShortest = 8, kLongest = 128;  ///< steps
  static constexpr double kElsewhere = 1.0;  ///< m: who has come so far sees others, and waits no more

  /// Whether none goes up in the next step but who must.
  bool holds() const { return left_ > 0; }
  /// After a step: whether its budget sent some back; how far the viewpoints have come by now, m.
  void note(bool sent_back, double traveled) {
    if (std::abs(traveled - from_) > kElsewhere) *this = {}, from_ = traveled;
    if (holds()) {
      --left_, since_ = 0;
    } else if (++since_ > length_) {
      length_ = std::max(length_ / 2, kShortest / 2), since_ = 0;
    }
    if (!sent_back) return;
    if (!holds()) length_ = std::min(2 * length_, kLongest);
    left_ = length_;
  }
  void archive(StateArchive& a) { a(left_, length_, since_, from_); }

 private:
  std::int32_t left_ = 0, length_ = kShortest / 2;  // steps: of this pause; of the last one
  std::int32_t since_ = 0;                          // steps since it ended, or was last halved
  double from_ = 0.0;                               // m: where the viewpoints were then
};

}  // namespace lodestone
