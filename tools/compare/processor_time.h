// Time that a thread spent computing, so that what else the machine does counts little.
#pragma once

#include <time.h>

namespace lodestone {

/// ns, of the calling thread.
inline double processor_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * double(now.tv_sec) + double(now.tv_nsec);
}

/// ns that `work()` takes of the calling thread.
template <typename Work>
double measure_processor_ns(Work work) {
  const double start = processor_ns();
  work();
  return processor_ns() - start;
}

}  // namespace lodestone
