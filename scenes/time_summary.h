// Median and tail of what was timed.
#pragma once

#include <span>

namespace lodestone {

/// Of a sample of milliseconds.
struct TimeSummary { double p50 = 0, p95 = 0, p99 = 0, mean = 0, max = 0; };

/// Percentiles are interpolated between the nearest ranks; all 0 for no sample.
TimeSummary summarize(std::span<const double> sample_ms);

}  // namespace lodestone
