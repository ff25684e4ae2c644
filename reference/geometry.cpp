#include "reference/geometry.h"

#include <Eigen/Eigenvalues>

namespace lodestone {

Quat rotation_between(const Vec3& from, const Vec3& to) {
  return Quat(Eigen::Quaterniond::FromTwoVectors(from, to));
}

PrincipalAxes find_principal_axes(const Mat3& tensor) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(tensor);
  PrincipalAxes principal{solver.eigenvalues(), solver.eigenvectors()};
  if (principal.axes.determinant() < 0.0) principal.axes.col(0) = -principal.axes.col(0);
  return principal;
}

Vec3 find_principal_moments(const Mat3& tensor) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace lodestone
