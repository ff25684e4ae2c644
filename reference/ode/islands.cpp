#include "reference/ode/islands.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lodestone {

int largest_island(std::span<const OdeContact> contacts) {
  std::uint32_t greatest = 0;
  for (const OdeContact& c : contacts) greatest = std::max({greatest, c.first.value, c.second.value});
  std::vector<std::uint32_t> parent(greatest + 1);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root_of = [&](std::uint32_t body) {
    while (parent[body] != body) body = parent[body] = parent[parent[body]];
    return body;
  };
  for (const OdeContact& c : contacts)
    if (c.second) parent[root_of(c.first.value)] = root_of(c.second.value);
  std::vector<int> count(parent.size());
  for (const OdeContact& c : contacts) ++count[root_of(c.first.value)];
  return *std::max_element(count.begin(), count.end());
}

}  // namespace lodestone
