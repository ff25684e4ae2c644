#include "reference/ode/islands.h"

#include <algorithm>
#include <vector>

#include "reference/disjoint_sets.h"

namespace lodestone {

int largest_island(std::span<const OdeContact> contacts) {
  // Numbered from zero: an id's value holds its generation, so it may be large.
  std::vector<std::uint32_t> bodies;
  for (const OdeContact& c : contacts) bodies.insert(bodies.end(), {c.first.value, c.second.value});
  std::ranges::sort(bodies);
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  const auto number_of = [&](OdeBodyId body) {
    return std::int32_t(std::ranges::lower_bound(bodies, body.value) - bodies.begin());
  };

  DisjointSets islands;
  islands.set_all_apart(bodies.size());
  for (const OdeContact& c : contacts)
    if (c.second) islands.join(number_of(c.first), number_of(c.second));
  std::vector<int> count(bodies.size());
  for (const OdeContact& c : contacts) ++count[std::size_t(islands.root_of(number_of(c.first)))];
  return count.empty() ? 0 : std::ranges::max(count);
}

}  // namespace lodestone
