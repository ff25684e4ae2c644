// The bunny of the paper's examples, from Debian's package glmark2-data.
#include <fmt/format.h>

#include "reference/error.h"
#include "reference/mesh/simplified_shapes.h"
#include "reference/shape.h"

namespace lodestone {

Shape make_bunny_shape(double size_m, int faces) {
  const std::filesystem::path file = "/usr/share/glmark2/models/bunny.obj";
  if (!std::filesystem::exists(file))
    throw InputError(file.string() +
                     ": found no such file, expected the package glmark2-data to be installed");
  // Simplified before it is scaled, so that bunnies of all sizes are scaled copies.
  const Mesh whole = repair_mesh(load_mesh(file), "bunny");
  return make_shape("bunny", scale_to_size(simplify_mesh(whole, faces), size_m));
}

}  // namespace lodestone
