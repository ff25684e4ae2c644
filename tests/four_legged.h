// A table.
#pragma once

#include <algorithm>
#include <array>
#include <memory>

#include "reference/mesh/mesh.h"
#include "reference/shape.h"

namespace lodestone::testing {

// A plate of .5 m on four legs of .35, all .05 m thick.
inline Mesh make_four_legged() {
  constexpr std::array kAcross{-0.25, -0.2, 0.2, 0.25};
  constexpr std::array kUp{-0.375, -0.025, 0.025};
  const auto is_solid = [](int i, int j, int k) {
    const auto is_at_side = [](int at) { return at == 0 || at == 2; };
    const bool within = i >= 0 && i < 3 && j >= 0 && j < 3 && k >= 0 && k < 2;
    return within && (k == 1 || (is_at_side(i) && is_at_side(j)));
  };
  Mesh mesh;
  const auto corner = [&](const std::array<int, 3>& at) {
    const Vec3 place(kAcross[std::size_t(at[0])], kAcross[std::size_t(at[1])], kUp[std::size_t(at[2])]);
    const auto known = std::ranges::find(mesh.vertices, place);
    if (known != mesh.vertices.end()) return int(known - mesh.vertices.begin());
    mesh.vertices.push_back(place);
    return int(mesh.vertices.size()) - 1;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 2; ++k)
        for (int axis = 0; is_solid(i, j, k) && axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside{i, j, k};
            beside[std::size_t(axis)] += side ? 1 : -1;
            if (is_solid(beside[0], beside[1], beside[2])) continue;
            std::array<int, 4> face{};
            for (int n = 0; n < 4; ++n) {
              std::array<int, 3> at{i, j, k};
              at[std::size_t(axis)] += side;
              at[std::size_t((axis + 1) % 3)] += n == 1 || n == 2;
              at[std::size_t((axis + 2) % 3)] += n >= 2;
              face[std::size_t(side ? n : 3 - n)] = corner(at);
            }
            mesh.faces.push_back({face[0], face[1], face[2]}),
                mesh.faces.push_back({face[0], face[2], face[3]});
          }
  return mesh;
}

inline std::shared_ptr<const Shape> four_legged_shape() {
  return std::make_shared<const Shape>(make_shape("four-legged", make_four_legged()));
}

}  // namespace lodestone::testing
