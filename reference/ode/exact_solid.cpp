#include "reference/ode/exact_solid.h"

#include <utility>

#include "reference/error.h"

namespace lodestone::ode {

// What cannot be a solid is left to ODE's own colliders.
std::shared_ptr<const Shape> find_exact_solid(const std::string& name, Mesh mesh) {
  constexpr std::size_t kFewFaces = 2000;
  if (mesh.faces.size() > kFewFaces) return {};
  try {
    MeshReport report;
    auto solid = std::make_shared<const Shape>(make_shape(name, std::move(mesh), {}, &report));
    const bool is_exact = report.faces_flipped == 0 && (solid->convex || !solid->pieces.empty());
    return is_exact ? std::move(solid) : nullptr;
  } catch (const InputError&) {
    return {};
  }
}

std::vector<Piece> pieces_in_mesh(const Shape& solid) {
  const Vec3& center = solid.center_of_mass_in_mesh;
  if (solid.convex) return {{&solid, center}};
  std::vector<Piece> pieces;
  for (const Shape& piece : solid.pieces) pieces.push_back({&piece, center + piece.center_of_mass_in_mesh});
  return pieces;
}

}  // namespace lodestone::ode
