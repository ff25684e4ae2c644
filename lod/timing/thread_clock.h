// Processor time of the calling thread: what a budget counts, whatever else the machine does.
#pragma once

#include <ctime>

namespace lodestone {

inline double thread_time_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

/// Processor time between laps, or nothing where it is not `running`, since each reading costs some of it.
class ThreadLaps {
 public:
  explicit ThreadLaps(bool running) : running_(running), last_ms_(running ? thread_time_ms() : 0.0) {}
  double lap_ms() {
    if (!running_) return 0.0;
    const double before = last_ms_;
    return (last_ms_ = thread_time_ms()) - before;
  }

 private:
  bool running_;
  double last_ms_;
};

}  // namespace lodestone
