#include "lod/statistical/statistical_body.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

// However it moves, it collides nearly as high as its bounding sphere would.
bool is_round(const Shape& shape, const Signature* signature) {
  constexpr double kRound = 0.95;  // over R
  return shape.sphere_radius || (signature && !signature->collision_heights.mean.empty() &&
                                 std::ranges::min(signature->collision_heights.mean) > kRound);
}

// Of a sphere no edge is.
bool has_long_edges(const Shape& shape) {
  constexpr double kLong = 0.2;  // over R
  if (shape.sphere_radius) return false;
  const Hull& hull = shape.hull;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i)
    for (const std::int32_t next : hull.neighbors(int(i)))
      if ((hull.vertices[std::size_t(next)] - hull.vertices[i]).norm() < kLong * shape.radius) return false;
  return true;
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
  kind.long_edges = has_long_edges(*shape);
  kind.shape = std::move(shape);
  kind.signature = std::move(signature);
  kind.material = material;
  return kind;
}

}  // namespace lodestone
