// Adds the wall time of a scope to one field of StageTimes.
#pragma once

#include <chrono>

namespace lodestone {

class StageTimer {
 public:
  explicit StageTimer(double& milliseconds) : milliseconds_(milliseconds), start_(Clock::now()) {}
  ~StageTimer() { milliseconds_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& milliseconds_;
  Clock::time_point start_;
};

}  // namespace lodestone
