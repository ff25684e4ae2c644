#include "reference/ode/islands.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lodestone {

int largest_island(std::span<const OdeContact> contacts) {
  std::vector<std::uint32_t> ids;  // an id holds its slot's generation, too: far apart, so they are numbered here
  for (const OdeContact& c : contacts) {
    ids.push_back(c.first.value);
    if (c.second) ids.push_back(c.second.value);
  }
  std::ranges::sort(ids);
  ids.erase(std::ranges::unique(ids).begin(), ids.end());
  const auto number_of = [&](OdeBodyId body) { return int(std::ranges::lower_bound(ids, body.value) - ids.begin()); };

  std::vector<int> parent(ids.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root_of = [&](int body) {
    while (parent[body] != body) body = parent[body] = parent[parent[body]];
    return body;
  };
  for (const OdeContact& c : contacts)
    if (c.second) parent[root_of(number_of(c.first))] = root_of(number_of(c.second));
  std::vector<int> count(ids.size(), 0);
  for (const OdeContact& c : contacts) ++count[root_of(number_of(c.first))];
  return count.empty() ? 0 : std::ranges::max(count);
}

}  // namespace lodestone
