#include "reference/mesh/mass_properties.h"

namespace lodestone {

MassProperties measure_mass_properties(const Mesh& mesh) {
  // About the middle of the bounding box, so that a mesh far from the origin loses no digits.
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  const Vec3 middle = mesh.vertices.empty() ? Vec3::Zero() : Vec3(box.center());

  // One tetrahedron per face, from the middle: det = 6 × its volume, signed.
  double volume = 0.0;
  Vec3 first_moment = Vec3::Zero();
  Mat3 second_moment = Mat3::Zero();
  for (const auto& face : mesh.faces) {
    const Vec3 a = mesh.vertices[face[0]] - middle, b = mesh.vertices[face[1]] - middle,
               c = mesh.vertices[face[2]] - middle, sum = a + b + c;
    const double det = a.dot(b.cross(c));
    volume += det / 6.0;
    first_moment += det / 24.0 * sum;
    second_moment +=
        det / 120.0 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  if (volume == 0.0) return {0.0, middle, Mat3::Zero()};
  const Vec3 center = first_moment / volume;
  const Mat3 covariance = second_moment / volume - center * center.transpose();
  return {volume, middle + center, covariance.trace() * Mat3::Identity() - covariance};
}

bool is_possible_inertia(const Mat3& inertia_per_mass) {
  constexpr double kTolerance = 1e-9;
  if (!inertia_per_mass.allFinite()) return false;
  const double scale = inertia_per_mass.cwiseAbs().maxCoeff();
  if ((inertia_per_mass - inertia_per_mass.transpose()).cwiseAbs().maxCoeff() > kTolerance * scale)
    return false;
  const Vec3 moments = find_principal_axes(inertia_per_mass).moments;
  return moments[0] > 0.0 && moments[0] + moments[1] >= moments[2] * (1.0 - kTolerance);
}

}  // namespace lodestone
