#include "lod/tables/sphere_kinds.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lod/tables/tables_model.h"

namespace lodestone {

void SphereKinds::add(const BodyKind& kind, double gravity) {
  const Shape& shape = *kind.shape;
  const Mat3& inverse = shape.inverse_inertia_per_mass;
  any_slender |= is_slender(kind);
  material.push_back(kind.material);
  radius.push_back(float(shape.radius));
  inverse_mass.push_back(float(1.0 / kind.mass));
  ixx.push_back(float(inverse(0, 0))), iyy.push_back(float(inverse(1, 1))), izz.push_back(float(inverse(2, 2)));
  ixy.push_back(float(inverse(0, 1))), ixz.push_back(float(inverse(0, 2))), iyz.push_back(float(inverse(1, 2)));
  const Mat3& inertia = shape.inertia_per_mass;
  jxx.push_back(float(inertia(0, 0))), jyy.push_back(float(inertia(1, 1))), jzz.push_back(float(inertia(2, 2)));
  jxy.push_back(float(inertia(0, 1))), jxz.push_back(float(inertia(0, 2))), jyz.push_back(float(inertia(1, 2)));
  softest.push_back(float(Eigen::SelfAdjointEigenSolver<Mat3>(inverse, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff()));
  const auto height_at = [&](int sample) {
    if (!kind.signature || kind.signature->collision_heights.mean.empty()) return 1.0;
    const double alpha = std::numbers::pi / 2 * std::min(sample, kHeightSamples - 1) / (kHeightSamples - 1);
    return find_collision_height(kind.signature->collision_heights, alpha).mean;
  };
  for (int i = 0; i <= kHeightSamples; ++i) height.push_back(float(height_at(i) * shape.radius));
  blend_time.push_back(float(TablesSettings{}.blend_time * std::sqrt(shape.radius / std::max(1e-9, gravity))));
  first_pose.push_back(std::int32_t(pose_height.size()));
  const auto add_pose = [&](const Vec3& normal, double over_radius) {
    pose_height.push_back(float(over_radius * shape.radius));
    pose_x.push_back(float(normal.x())), pose_y.push_back(float(normal.y())), pose_z.push_back(float(normal.z()));
  };
  if (kind.signature)
    for (const RestPose& pose : kind.signature->rest_poses) add_pose(pose.normal, pose.height);
  if (!kind.signature || kind.signature->rest_poses.empty()) add_pose(Vec3::UnitZ(), 1.0);
}

}  // namespace lodestone
