#include "scenes/time_summary.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lodestone {

TimeSummary summarize(std::span<const double> sample_ms) {
  if (sample_ms.empty()) return {};
  std::vector<double> sorted(sample_ms.begin(), sample_ms.end());
  std::ranges::sort(sorted);
  const auto percentile = [&](double part) {
    const double rank = part * double(sorted.size() - 1);
    const std::size_t below = std::size_t(rank), above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (rank - double(below)) * (sorted[above] - sorted[below]);
  };
  const double mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / double(sorted.size());
  return {percentile(0.5), percentile(0.95), percentile(0.99), mean, sorted.back()};
}

}  // namespace lodestone
