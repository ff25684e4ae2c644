#include "lod/support/clip_player.h"

#include <cmath>

#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

constexpr double kSlides = 0.01;  // of its kinetic energy: with less it does not rock

// The part of `rotation` about `axis` (swing–twist decomposition).
Quat twist_about(const Quat& rotation, const Vec3& axis) {
  const double along = rotation.vec().dot(axis);
  Quat twist(rotation.w(), along * axis.x(), along * axis.y(), along * axis.z());
  const double norm = twist.norm();
  return norm > 1e-9 ? Quat(twist.coeffs() / norm) : Quat(1, 0, 0, 0);
}

Vec3 rotation_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q.w() < 0.0 ? Quat(-q.coeffs()) : q);
  return turn.angle() * turn.axis();
}

// Clips are recorded over the plane z = 0; `yaw` takes z to the ground's normal too.
RigidState state_of(const ClipPlayback& p, const BodyKind& kind, double gravity) {
  const ClipState clip = find_clip_state(*kind.signature, kind.signature->clips[p.clip], p.frame);
  const double radius = kind.shape->radius, speed_unit = std::sqrt(gravity * radius);
  const Mat3 yaw = p.yaw.toRotationMatrix();
  RigidState state{p.origin + yaw * (clip.position * radius), p.yaw * clip.orientation,
                   yaw * (clip.velocity * speed_unit), yaw * (clip.angular_velocity * (speed_unit / radius))};
  if (p.residual_left <= 0.0) return state;
  // Smoothstep, 3s² − 2s³: the residual begins and ends to fade without a jump of its speed.
  const double fade = p.residual_left * p.residual_left * (3.0 - 2.0 * p.residual_left);
  state.position += fade * p.residual_position;
  state.orientation = rotation_from_vector(fade * p.residual_rotation) * state.orientation;
  return state;
}

}  // namespace

std::optional<ClipPlayback> find_clip(const StatisticalBody& body, const BodyKind& kind,
                                      const HalfSpace& ground, double gravity, const ClipSettings& settings) {
  const Shape& shape = *kind.shape;
  const double radius = shape.radius, greatest = settings.energy_limit * gravity * radius;
  const double of_velocity = 0.5 * body.velocity.squaredNorm();
  if (of_velocity > greatest) return {};
  const Mat3 to_body = body.orientation.toRotationMatrix().transpose();
  const Vec3 spin = to_body * body.spin, omega = shape.inverse_inertia_per_mass * spin;
  const double kinetic = of_velocity + 0.5 * spin.dot(omega);
  if (kinetic > greatest) return {};

  const double height = ground.height_of(body.position), speed_unit = std::sqrt(gravity * radius);
  const SettlingKey key{
      (to_body * ground.normal).cast<float>(), (to_body * (body.velocity / speed_unit)).cast<float>(),
      (omega * (radius / speed_unit)).cast<float>(), float(kinetic / (gravity * radius) + height / radius)};
  // What slides and turns flat on the ground comes to rest by friction alone; of others, that part of their
  // motion is none that a clip may be off by.
  const Vec3 normal = to_body * ground.normal, tilting = omega - omega.dot(normal) * normal;
  const double rising = body.velocity.dot(ground.normal),
               rocking = 0.5 * (rising * rising + tilting.dot(shape.inertia_per_mass * tilting));
  if (rocking < kSlides * kinetic) return {};
  const auto energy = float(rocking / (gravity * radius));
  const float distance =
      std::clamp(settings.distance_over_energy * energy, settings.least_distance, settings.greatest_distance);
  const std::optional<ClipEntry> entry = kind.clips->find_nearest(key, settings.energy_slack, distance);
  if (!entry) return {};

  ClipPlayback p;
  p.clip = entry->clip;
  p.ground = ground;
  p.frame = entry->frame;
  p.residual_left = 1.0;
  const ClipState pose = find_clip_state(*kind.signature, kind.signature->clips[p.clip], p.frame);
  // The yaw frame: of all turns about the ground's normal the one that brings the clip's pose nearest to the
  // body's. What it leaves between them is a tilt, residual_rotation.
  const Quat upright = rotation_between(Vec3::UnitZ(), ground.normal);
  p.yaw = twist_about(body.orientation * (upright * pose.orientation).conjugate(), ground.normal) * upright;
  const Vec3 above_origin = p.yaw * (pose.position * radius);
  p.origin = body.position - above_origin;
  p.origin += (ground.offset - p.origin.dot(ground.normal)) * ground.normal;
  p.residual_position = body.position - p.origin - above_origin;
  p.residual_rotation = rotation_vector(body.orientation * (p.yaw * pose.orientation).conjugate());
  return p;
}

bool advance_clip(ClipPlayback& p, StatisticalBody& body, const BodyKind& kind, double gravity, double time,
                  const ClipSettings& settings) {
  const double time_unit = std::sqrt(kind.shape->radius / gravity);
  p.frame += time / (kind.signature->clip_frame_interval * time_unit);
  // fade_time is said for R = .2 m at 9.81 m/s²; in other worlds it is as many √(R/g).
  p.residual_left =
      std::max(0.0, p.residual_left - time / (settings.fade_time * time_unit / std::sqrt(0.2 / 9.81)));
  RigidState state = state_of(p, kind, gravity);
  if (p.residual_left > 0.0) {  // between two poses the hull may dip below the ground
    const double gap = find_lowest_point(*kind.shape, state.orientation, p.ground.normal,
                                         p.ground.height_of(state.position), body.support_hint)
                           .gap;
    if (gap < 0.0) state.position -= gap * p.ground.normal;
  }
  body.position = state.position;
  body.orientation = state.orientation.normalized();
  body.velocity = state.velocity;
  body.spin = spin_of(body.orientation, state.angular_velocity, *kind.shape);
  return p.frame >= kind.signature->clips[p.clip].frames - 1.0 && p.residual_left <= 0.0;
}

}  // namespace lodestone
