#include "scenes/camera.h"

#include <cmath>

namespace lodestone {

Quat camera_rotation(const Vec3& position, const Vec3& target) {
  Vec3 back = position - target;
  back = back.norm() > 1e-9 ? Vec3(back.normalized()) : Vec3(-Vec3::UnitY());
  Vec3 right = Vec3::UnitZ().cross(back);
  right = right.norm() > 1e-9 ? Vec3(right.normalized()) : Vec3::UnitX();
  Mat3 axes;
  axes << right, back.cross(right), back;
  return Quat(axes);
}

bool Camera::sees(const Vec3& point) const {
  const Vec3 seen = to_camera_ * (point - position_);  // z backwards
  const double half_height = -seen.z() * std::tan(0.5 * kFieldOfView);
  return seen.z() < 0.0 && std::abs(seen.y()) <= half_height &&
         std::abs(seen.x()) <= kAspectRatio * half_height;
}

}  // namespace lodestone
