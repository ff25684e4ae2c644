// Steps of unequal length, as of a game that spends what is left of a frame: what of a contact's impulse in
// one of them may be expected in the next. A weight presses for as long as a step is; what stops a body takes
// no time, and as a force that lasted it would throw the body in a longer step.
#pragma once

#include <algorithm>

#include "reference/state_archive.h"

namespace lodestone {

class StepLengths {
 public:
  struct Shares {
    bool remembers = true;     ///< what contacts give in this step; else what is known already stays
    double of_forces = 1.0;    ///< of those known, 1 at most
    double of_impulses = 1.0;  ///< likewise, where they were kept as they were
  };

  /// A step of `dt` seconds begins.
  Shares begin(double dt) {
    constexpr double kShort = 0.5;    // over the length remembered: in less than so a force is mostly a stop
    constexpr double kForgets = 0.8;  // of that length is kept, once steps are shorter
    constexpr double kGrowth = 2.0;   // of a step, in which a force may still be expected to last
    Shares shares;
    if (last_ > 0.0) {
      shares.remembers = dt >= kShort * remembered_;
      shares.of_forces = std::min(1.0, kGrowth * remembered_ / dt);
      shares.of_impulses = std::min(1.0, dt / last_);
    }
    remembered_ = shares.remembers ? dt : kForgets * remembered_;
    last_ = dt;
    return shares;
  }
  void archive(StateArchive& a) { a(remembered_, last_); }

 private:
  double remembered_ = 0.0, last_ = 0.0;  // s: about that in which what is known was given; 0: none yet
};

}  // namespace lodestone
