#include "lod/manager/driven_bodies.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kHeldFor = 1.0;  // s
constexpr double kHeld = 0.5;     // of the speed that is asked: slower it is held

double speed_of(const Neighborhood& neighborhood, const FullContact& contact) {
  const auto velocity_of = [&](std::int32_t index) {
    if (index < 0) return Vec3(Vec3::Zero());
    const RigidState& state = neighborhood.bodies[std::size_t(index)].state;
    return Vec3(state.velocity + state.angular_velocity.cross(contact.point - state.position));
  };
  return (velocity_of(contact.first) - velocity_of(contact.second)).dot(contact.normal);
}

}  // namespace

void DrivenBodies::mark(Neighborhood& neighborhood, double dt) {
  std::swap(motors_, before_);
  motors_.clear();
  for (const FullContact& contact : neighborhood.contacts) {
    if (!contact.drive || contact.drive->speed <= 0.0) continue;
    FullNeighbor& body = neighborhood.bodies[std::size_t(contact.first)];
    Motor motor{body.owner, contact.drive->speed, 0.0};
    if (speed_of(neighborhood, contact) < kHeld * motor.speed) {
      const auto before = std::ranges::lower_bound(before_, motor.owner, {}, &Motor::owner);
      const bool known =
          before != before_.end() && before->owner == motor.owner && before->speed == motor.speed;
      motor.held_s = dt + (known ? before->held_s : 0.0);
    }
    body.driven |= motor.held_s < kHeldFor;
    motors_.push_back(motor);
  }
  std::ranges::sort(motors_, {}, &Motor::owner);
}

}  // namespace lodestone
