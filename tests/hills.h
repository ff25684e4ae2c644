// Gentle terrain of triangles.
#pragma once

#include <cmath>

#include "reference/mesh/mesh.h"

namespace lodestone::testing {

/// m: slopes of .2 at most.
inline double height_of_hills(double x, double y) { return 0.4 * std::sin(0.5 * x) * std::cos(0.4 * y); }

/// In cells of a metre, two triangles each, whose ridges stand out by up to 11°: x from -10, y from -10 m.
inline Mesh make_hills(int along_x, int along_y) {
  Mesh mesh;
  for (int i = 0; i <= along_x; ++i)
    for (int j = 0; j <= along_y; ++j)
      mesh.vertices.push_back({i - 10.0, j - 10.0, height_of_hills(i - 10, j - 10)});
  for (int i = 0; i < along_x; ++i)
    for (int j = 0; j < along_y; ++j) {
      const int a = i * (along_y + 1) + j, b = a + along_y + 1;
      mesh.faces.push_back({a, b, b + 1}), mesh.faces.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

}  // namespace lodestone::testing
