// How fast the machine moves memory: a triad over arrays of our own (McCalpin, Memory bandwidth and machine
// balance, 1995).
#pragma once

#include <cstddef>

namespace lodestone {

/// Of this machine's caches, each of one core or shared; what is usual where it does not say.
std::size_t level2_bytes();
std::size_t level3_bytes();

/// GB/s of a[i] = b[i] + s c[i] over three arrays of `bytes` in all, each thread with its own part: the best
/// of several rounds. Two reads and a write count; the read that a write brings with it does not.
double measure_bandwidth(std::size_t bytes, int threads);

/// GB/s, one thread and `threads`: over arrays four times the third level's cache, and over half of the
/// second one's for each thread.
struct Bandwidth {
  int threads = 1;
  double memory_one = 0.0, memory = 0.0, cache_one = 0.0, cache = 0.0;
};
Bandwidth measure_bandwidth(int threads);

}  // namespace lodestone
