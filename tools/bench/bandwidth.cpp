#include "tools/bench/bandwidth.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "lod/jobs.h"

namespace lodestone {
namespace {

std::size_t cache_bytes([[maybe_unused]] int name, std::size_t usual) {
#ifdef _SC_LEVEL2_CACHE_SIZE
  const long bytes = sysconf(name);
  if (bytes > 0) return std::size_t(bytes);
#endif
  return usual;
}

constexpr double kRoundsS = 0.3;  // s spent at least, and eight rounds

}  // namespace

#ifdef _SC_LEVEL2_CACHE_SIZE
std::size_t level2_bytes() { return cache_bytes(_SC_LEVEL2_CACHE_SIZE, 1 << 20); }
std::size_t level3_bytes() { return cache_bytes(_SC_LEVEL3_CACHE_SIZE, 32 << 20); }
#else
std::size_t level2_bytes() { return cache_bytes(0, 1 << 20); }
std::size_t level3_bytes() { return cache_bytes(0, 32 << 20); }
#endif

double measure_bandwidth(std::size_t bytes, int threads) {
  const std::size_t count = std::max<std::size_t>(64, bytes / (3 * sizeof(double)));
  std::vector<double> a(count, 0.0), b(count, 1.0), c(count, 2.0);
  const JobRunner jobs = make_job_runner(threads);
  // Small arrays several times in a row, so that starting the threads does not count.
  const int repeats = int(std::max<std::size_t>(1, (std::size_t(8) << 20) / (count * 3 * sizeof(double))));
  double best_s = 1e300, spent_s = 0.0;
  for (int round = 0; round < 8 || spent_s < kRoundsS; ++round) {
    const auto start = std::chrono::steady_clock::now();
    jobs(threads, TaskRef([&](std::int64_t part) {
           const std::size_t begin = count * std::size_t(part) / std::size_t(threads),
                             end = count * std::size_t(part + 1) / std::size_t(threads);
           for (int repeat = 0; repeat < repeats; ++repeat) {
             const double scale = 0.5 + repeat;  // so that no repeat can be left out
             double* to = a.data();
             const double *x = b.data(), *y = c.data();
#pragma GCC ivdep
             for (std::size_t i = begin; i < end; ++i) to[i] = x[i] + scale * y[i];
             asm volatile("" : : "r"(to) : "memory");
           }
         }));
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    best_s = std::min(best_s, s / repeats), spent_s += s;
  }
  return 1e-9 * double(count * 3 * sizeof(double)) / best_s;
}

Bandwidth measure_bandwidth(int threads) {
  const std::size_t large = std::max<std::size_t>(64 << 20, 4 * level3_bytes()), small = level2_bytes() / 2;
  return {threads, measure_bandwidth(large, 1), measure_bandwidth(large, threads),
          measure_bandwidth(small, 1), measure_bandwidth(small * std::size_t(threads), threads)};
}

}  // namespace lodestone
