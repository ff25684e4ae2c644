// Median and tail of what was timed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lodestone {

/// Of a sample of milliseconds.
struct TimeSummary {
  double p50 = 0, p95 = 0, p99 = 0, mean = 0, max = 0;
};

/// Percentiles are interpolated between the nearest ranks; all 0 for no sample.
TimeSummary summarize(std::span<const double> sample_ms);

/// A sample of any length in at most 150 kB. Up to kExactTimes its summary is that of summarize(); beyond,
/// percentiles are read off a histogram whose cells are 1/128 of an octave wide, so that they are right to .3
/// %, and mean and maximum stay exact.
inline constexpr std::size_t kExactTimes = 1 << 13;
class TimeTally {
 public:
  void add(double ms);
  TimeSummary summary() const;

 private:
  double percentile(double part) const;
  std::vector<double> exact_;         // until there are too many of them,
  std::vector<std::uint64_t> cells_;  // then their number in each cell
  std::uint64_t count_ = 0;
  double sum_ = 0, max_ = 0;
};

}  // namespace lodestone
