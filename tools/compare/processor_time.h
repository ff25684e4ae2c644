// Time that a thread spent computing, so that what else the machine does counts little.
#pragma once

#include "lod/timing/thread_clock.h"

namespace lodestone {

/// ns, of the calling thread.
inline double processor_ns() { return 1e6 * thread_time_ms(); }

/// ns that `work()` takes of the calling thread.
template <typename Work>
double measure_processor_ns(Work work) {
  const double start = processor_ns();
  work();
  return processor_ns() - start;
}

}  // namespace lodestone
