#include "reference/mesh/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace lodestone {

void visit_edges(const Mesh& mesh, const std::function<void(std::span<const EdgeUse>)>& visit) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.faces.size());
  for (int face = 0; face < int(mesh.faces.size()); ++face)
    for (int i = 0; i < 3; ++i) {
      const int from = mesh.faces[face][i], to = mesh.faces[face][(i + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), face, from < to});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  for (auto begin = uses.begin(); begin != uses.end();) {
    const auto end = std::find_if(begin, uses.end(), [&](const EdgeUse& use) {
      return use.low != begin->low || use.high != begin->high;
    });
    visit({begin, end});
    begin = end;
  }
}

}  // namespace lodestone
