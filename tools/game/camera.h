// From where the game is seen: a flying camera, and the path that it takes by itself for a picture.
#pragma once

#include <lodestone/lodestone.h>

#include <cmath>

namespace game {

struct Camera {
  lodestone::Vec3 position{-9.0, -11.0, 4.2};  // m
  double yaw = 0.9, pitch = -0.24;             // rad; of the direction of sight, from x towards y, and up

  lodestone::Vec3 direction() const {
    return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
  }
  lodestone::Vec3 right() const { return {std::sin(yaw), -std::cos(yaw), 0.0}; }
  lodestone::Vec3 up() const { return right().cross(direction()); }
  void look_at(const lodestone::Vec3& target) {
    const lodestone::Vec3 sight = (target - position).normalized();
    yaw = std::atan2(sight.y(), sight.x()), pitch = std::asin(sight.z());
  }
};

/// `time` in s: around the door, nearer and farther.
inline Camera scripted_camera(double time) {
  Camera camera;
  const double angle = -2.2 + 0.22 * time, distance = 11.0 + 3.0 * std::cos(0.4 * time);
  camera.position = {distance * std::cos(angle), distance * std::sin(angle), 3.6};
  camera.look_at({0.0, 0.5, 0.9});
  return camera;
}

}  // namespace game
