// The mean, the median and other percentiles of what was measured.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lodestone {

/// There must be at least one.
inline double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// Of an even number the upper one in the middle. There must be at least one.
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The least of `sorted` that so large a part (0 < part ≤ 1) of them does not exceed; 0 for none.
inline double percentile_of(const std::vector<double>& sorted, double part) {
  return sorted.empty() ? 0.0 : sorted[std::size_t(std::ceil(part * double(sorted.size()))) - 1];
}

}  // namespace lodestone
