// The median of what was measured.
#pragma once

#include <algorithm>
#include <vector>

namespace lodestone {

/// Of an even number the upper one in the middle. There must be at least one.
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace lodestone
