// Trials of a method, many at once, each seen at 60 Hz.
#pragma once

#include <cstdint>
#include <functional>

#include "tools/methods/method_world.h"

namespace lodestone {

/// Calls `run(trial)` for 0 … count − 1 on `threads` threads (0: all cores), and `progress`, if any, with the
/// fraction done, from one thread at a time. Interrupted once the program was (tools/interrupt.h).
void run_trials(int count, int threads, const std::function<void(int)>& run,
                const std::function<void(double)>& progress = {});

/// Steps `world` by `dt`, and calls `look(time_s)` at the states that were reached by each 1/60 s, until that
/// returns false or the time is over.
template <class Look>
void watch(MethodWorld& world, double dt, double horizon_s, Look look) {
  std::int64_t steps = 0;
  bool goes_on = look(0.0);
  for (int k = 1; goes_on && k * kObservationStep <= horizon_s + 1e-9; ++k) {
    const std::int64_t before = steps;
    for (; double(steps + 1) * dt <= k * kObservationStep + 0.01 * dt; ++steps) world.step(dt);
    if (steps > before) goes_on = look(double(steps) * dt);
  }
}

}  // namespace lodestone
