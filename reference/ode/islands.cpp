#include "reference/ode/islands.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lodestone {

int largest_island(std::span<const OdeContact> contacts) {
  // Numbered from zero: an id's value holds its generation, so it may be large.
  std::vector<std::uint32_t> bodies;
  for (const OdeContact& c : contacts) bodies.insert(bodies.end(), {c.first.value, c.second.value});
  std::ranges::sort(bodies);
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  const auto number_of = [&](OdeBodyId body) {
    return std::size_t(std::ranges::lower_bound(bodies, body.value) - bodies.begin());
  };

  std::vector<std::size_t> parent(bodies.size());
  std::iota(parent.begin(), parent.end(), std::size_t(0));
  const auto root_of = [&](OdeBodyId body) {
    std::size_t root = number_of(body);
    while (parent[root] != root) root = parent[root] = parent[parent[root]];
    return root;
  };
  for (const OdeContact& c : contacts)
    if (c.second) parent[root_of(c.first)] = root_of(c.second);
  std::vector<int> count(bodies.size());
  for (const OdeContact& c : contacts) ++count[root_of(c.first)];
  return count.empty() ? 0 : std::ranges::max(count);
}

}  // namespace lodestone
