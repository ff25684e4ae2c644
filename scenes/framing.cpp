#include "scenes/framing.h"

#include <algorithm>
#include <cmath>

#include "scenes/camera.h"

namespace lodestone {
namespace {

constexpr int kFrames = 8;         // looked at, evenly over the trajectory
constexpr double kOutside = 0.01;  // of the bodies: they may be outside

Vec3 position_of(const Trajectory& trajectory, int frame, int body) {
  const Trajectory::Position& p = trajectory.position(frame, body);
  return {p[0], p[1], p[2]};
}

std::vector<Vec3> sample_positions(const Trajectory& trajectory) {
  std::vector<Vec3> positions;
  for (int i = 0; i < kFrames; ++i)
    for (int body = 0; body < trajectory.bodies(); ++body)
      positions.push_back(position_of(trajectory, i * (trajectory.frames() - 1) / (kFrames - 1), body));
  std::erase_if(positions, [](const Vec3& p) { return !p.allFinite(); });
  return positions;
}

double quantile(std::vector<double>& values, double share) {
  const auto nth = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::ranges::nth_element(values, nth);
  return *nth;
}

}  // namespace

SceneViewpoint frame_bodies(const Trajectory& trajectory, const Scene& scene) {
  const std::vector<Vec3> positions = sample_positions(trajectory);
  SceneViewpoint viewpoint;
  viewpoint.position_m = {-3, -4, 2};
  if (positions.empty()) return viewpoint;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& p : positions) values.push_back(p[axis]);
    viewpoint.look_at_m[axis] = 0.5 * (quantile(values, kOutside) + quantile(values, 1 - kOutside));
  }
  std::vector<double> distances;
  for (const Vec3& p : positions) distances.push_back((p - viewpoint.look_at_m).norm());
  double radius = 0;
  for (const SceneBody& body : scene.bodies) radius = std::max(radius, body.definition.shape->radius);
  const double to_see_m = quantile(distances, 1 - kOutside) + radius;
  viewpoint.position_m =
      viewpoint.look_at_m + to_see_m / std::sin(0.5 * kFieldOfView) * Vec3(-0.5, -0.75, 0.45).normalized();
  return viewpoint;
}

}  // namespace lodestone
