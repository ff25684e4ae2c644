#include "lod/tables/sphere_forces.h"

#include <algorithm>

namespace lodestone {

void SphereForces::forget(int slot) {
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
}

void SphereForces::rename(int from, int to) {
  for (Push& push : pushes_)
    if (push.slot == std::int32_t(from)) push.slot = to;
}

void SphereForces::apply(double dt, SphereClips& clips, ContactTally& tally) {
  acting_.clear();
  for (const Push& push : pushes_) {
    const std::int64_t place = spheres_.place_of_slot[std::size_t(push.slot)];
    clips.end(place);  // it knows no force but gravity
    StatisticalBody body = spheres_.body(place);
    const double impulse = dt * spheres_.inverse_mass[std::size_t(place)];
    body.velocity += impulse * push.force;
    body.spin += impulse * push.torque;
    body.motion = Motion::dynamic;
    spheres_.put(place, body);
    if (body.velocity.dot(push.force) > impulse * push.force.squaredNorm())  // it gives way: at no rest
      spheres_.crowded_for[std::size_t(place)] = 0, spheres_.quiet[std::size_t(place)] = 0.0f;
    if (!is_within_limit(body.velocity) || !is_within_limit(body.spin))
      scene_.recover(place, tally);
    else
      acting_.add({push.slot, (impulse / dt) * push.force, (impulse / dt) * push.torque});
  }
  pushes_.clear();
  acting_.put_in_order();
}

std::span<const Eigen::Vector3f> SphereForces::by_place() {
  by_place_.clear();
  if (acting_.empty()) return by_place_;
  by_place_.assign(std::size_t(spheres_.awake), Eigen::Vector3f::Zero());
  for (const ActingForce& force : acting_.all()) {
    by_place_[scene_.place_of(force.slot)] = (constants_.wide_time * force.acceleration).cast<float>();
  }
  return by_place_;
}

void SphereForces::give(double share) {
  for (const ActingForce& force : acting_.all()) {
    const std::size_t i = scene_.place_of(force.slot);
    const Vec3 push = share * constants_.wide_time * force.acceleration;
    spheres_.vx[i] += push.x(), spheres_.vy[i] += push.y(), spheres_.vz[i] += push.z();
  }
}

void SphereForces::take_back_excess() {
  for (const ActingForce& force : acting_.all()) {
    const std::size_t i = scene_.place_of(force.slot);
    if (step_.on_ground[i] != std::uint8_t(GroundState::free) || step_.touches(std::int64_t(i))) continue;
    const Vec3 too_far = 0.5 * constants_.wide_time * constants_.wide_time * force.acceleration;
    spheres_.x[i] -= too_far.x(), spheres_.y[i] -= too_far.y(), spheres_.z[i] -= too_far.z();
  }
}

}  // namespace lodestone
