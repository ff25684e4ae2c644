// Adds the wall time of a scope to one field of StageTimes, and makes the scope a zone of the profiler that
// listens.
#pragma once

#include <chrono>

#include "lod/timing/stage_zones.h"

namespace lodestone {

class StageTimer {
 public:
  explicit StageTimer(double& milliseconds) : milliseconds_(milliseconds), start_(Clock::now()) {
    StageZones::begin(milliseconds_);
  }
  ~StageTimer() {
    milliseconds_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    StageZones::end(milliseconds_);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& milliseconds_;
  Clock::time_point start_;
};

}  // namespace lodestone
