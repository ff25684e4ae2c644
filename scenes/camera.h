// The picture that a viewpoint has of a scene: 60° high and 16 : 9, z upwards.
#pragma once

#include <numbers>

#include "reference/geometry.h"

namespace lodestone {

/// rad, from the lower edge of the picture to the upper.
inline constexpr double kFieldOfView = std::numbers::pi / 3;
inline constexpr double kAspectRatio = 16.0 / 9.0;

/// The rotation of a glTF camera, which looks along its −z with y upwards, at `position` looking at `target`
/// with z upwards.
Quat camera_rotation(const Vec3& position, const Vec3& target);

/// What a camera sees of a scene, whatever may stand in between.
class Camera {
 public:
  Camera(const Vec3& position, const Vec3& target)
      : position_(position), to_camera_(camera_rotation(position, target).conjugate()) {}
  bool sees(const Vec3& point) const;

 private:
  Vec3 position_;
  Quat to_camera_;
};

}  // namespace lodestone
