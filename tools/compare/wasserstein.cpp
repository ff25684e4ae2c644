#include "tools/compare/wasserstein.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "reference/error.h"

namespace lodestone {

SamplePair::SamplePair(std::span<const double> first, std::span<const double> second) {
  check_that(!first.empty() && !second.empty(), "both samples hold values");
  sorted_.reserve(first.size() + second.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) sorted_.push_back({first[i], i, true});
  for (std::uint32_t i = 0; i < second.size(); ++i) sorted_.push_back({second[i], i, false});
  std::ranges::sort(sorted_, {}, &Value::value);
}

double SamplePair::wasserstein(std::span<const std::uint32_t> first_counts,
                               std::span<const std::uint32_t> second_counts) const {
  const double per_first = 1.0 / std::accumulate(first_counts.begin(), first_counts.end(), 0.0);
  const double per_second = 1.0 / std::accumulate(second_counts.begin(), second_counts.end(), 0.0);
  double distance = 0.0, previous = sorted_.front().value;
  // Counts below each value, as integers, so that the difference of the distribution functions ends at zero.
  std::uint64_t first_below = 0, second_below = 0;
  for (const Value& v : sorted_) {
    distance +=
        std::abs(double(first_below) * per_first - double(second_below) * per_second) * (v.value - previous);
    previous = v.value;
    if (v.in_first)
      first_below += first_counts[v.index];
    else
      second_below += second_counts[v.index];
  }
  return distance;
}

double wasserstein_distance(std::span<const double> first, std::span<const double> second) {
  const std::vector<std::uint32_t> once(std::max(first.size(), second.size()), 1);
  return SamplePair(first, second)
      .wasserstein(std::span(once).first(first.size()), std::span(once).first(second.size()));
}

}  // namespace lodestone
