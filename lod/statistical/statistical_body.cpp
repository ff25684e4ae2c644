#include "lod/statistical/statistical_body.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lodestone {
namespace {

// However it moves, it collides nearly as high as its bounding sphere would.
bool is_round(const Shape& shape, const Signature* signature) {
  constexpr double kRound = 0.95;  // over R
  return shape.sphere_radius || (signature && !signature->collision_heights.mean.empty() &&
                                 std::ranges::min(signature->collision_heights.mean) > kRound);
}

// All edges are long, and at most of them faces turn by far: else, as over the sides of a coin, it would
// roll. Of a sphere no edge is.
bool is_angular(const Shape& shape) {
  constexpr double kLong = 0.2;                     // over R
  constexpr double kFlat = 0.9998, kSharp = 0.766;  // cosines between the normals of two faces: 1°, 40°
  constexpr double kMostBlunt = 0.2;                // of the edges
  if (shape.sphere_radius) return false;
  const Hull& hull = shape.hull;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i)
    for (const std::int32_t next : hull.neighbors(int(i)))
      if ((hull.vertices[std::size_t(next)] - hull.vertices[i]).norm() < kLong * shape.radius) return false;
  std::map<std::pair<int, int>, std::size_t> face_beside;
  int edges = 0, blunt = 0;
  for (std::size_t face = 0; face < hull.faces.size(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const int from = hull.faces[face][corner], to = hull.faces[face][(corner + 1) % 3];
      const auto [known, is_new] = face_beside.try_emplace(std::minmax(from, to), face);
      if (is_new) continue;
      const double cosine = hull.face_normals[face].dot(hull.face_normals[known->second]);
      if (cosine > kFlat) continue;
      ++edges;
      blunt += cosine > kSharp;
    }
  return blunt <= kMostBlunt * edges;
}

}  // namespace

BodyKind make_body_kind(std::shared_ptr<const Shape> shape, std::shared_ptr<const Signature> signature,
                        MaterialId material) {
  BodyKind kind;
  const PrincipalAxes principal = find_principal_axes(shape->inverse_inertia_per_mass);
  kind.principal_axes = Quat(principal.axes).normalized();
  kind.along_principal_axes = std::abs(kind.principal_axes.w()) > 1.0 - 1e-15;
  kind.inverse_moments = principal.moments;
  kind.isotropic = kind.inverse_moments[2] - kind.inverse_moments[0] < 1e-9 * kind.inverse_moments[2];
  kind.round = is_round(*shape, signature.get());
  kind.angular = is_angular(*shape);
  kind.shape = std::move(shape);
  kind.signature = std::move(signature);
  kind.material = material;
  return kind;
}

}  // namespace lodestone
