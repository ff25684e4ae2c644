#include "signature/measure/collision_vectors.h"

#include <algorithm>
#include <numbers>

namespace lodestone {
namespace {

// Columns e1, e2, e3. Where the body falls along the normal any working plane is as good.
Mat3 frame_of(const MeasuredCollision& c) {
  Vec3 e3 = c.normal.cross(c.velocity_before);
  if (e3.norm() <= 1e-9 * c.velocity_before.norm()) e3 = c.normal.unitOrthogonal();
  e3.normalize();
  Mat3 frame;
  frame << c.normal, e3.cross(c.normal), e3;
  return frame;
}

double angle_between(const Vec3& a, const Vec3& b) {
  const double lengths = a.norm() * b.norm();
  return lengths > 0.0 ? std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) : std::numbers::pi / 2;
}

}  // namespace

CollisionConfiguration configuration_of(const MeasuredCollision& c, double radius) {
  const Vec3 &v = c.velocity_before, &omega = c.angular_velocity_before, across = frame_of(c).col(2);
  const double psi = std::atan2(omega.dot(across) * v.norm(), omega.dot(across.cross(v)));
  return {.theta = angle_between(v, -c.normal),
          .phi = angle_between(v, omega),
          .psi = psi < 0.0 ? psi + 2.0 * std::numbers::pi : psi,
          .speed = v.norm(),
          .spin = radius * omega.norm()};
}

Response response_of(const MeasuredCollision& c, double radius, double restitution) {
  const Mat3 into_frame = frame_of(c).transpose();
  const double unit = std::hypot(c.velocity_before.norm(), radius * c.angular_velocity_before.norm());
  const Vec3 particle = c.velocity_before - (1.0 + restitution) * c.velocity_before.dot(c.normal) * c.normal;
  Eigen::Matrix<double, 6, 1> response;
  response << into_frame * (c.velocity_after - particle) / unit,
      into_frame * c.angular_velocity_after * (radius / unit);
  return response.cast<float>();
}

MeasuredCollision collision_with(const CollisionConfiguration& c, const Response& response, double radius,
                                 double restitution) {
  const Vec3 along(std::sin(c.theta), 0.0, -std::cos(c.theta)), across = Vec3::UnitY(),
                                                                in_plane = across.cross(along);
  MeasuredCollision collision;
  collision.velocity_before = c.speed * along;
  collision.angular_velocity_before =
      c.spin / radius *
      (std::cos(c.phi) * along + std::sin(c.phi) * (std::cos(c.psi) * in_plane + std::sin(c.psi) * across));
  const Vec3 particle =
      collision.velocity_before - (1.0 + restitution) * collision.velocity_before.z() * Vec3::UnitZ();
  const auto in_world = [](const Vec3& v) {
    return Vec3(v.y(), v.z(), v.x());
  };  // from (e1, e2, e3) = (z, x, y)
  collision.velocity_after = particle + c.speed_unit() * in_world(response.head<3>().cast<double>());
  collision.angular_velocity_after = c.speed_unit() / radius * in_world(response.tail<3>().cast<double>());
  return collision;
}

}  // namespace lodestone
