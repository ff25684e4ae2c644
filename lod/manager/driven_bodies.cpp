#include "lod/manager/driven_bodies.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kHeldFor = 1.0;  // s
constexpr double kHeld = 0.5;     // of the speed that is asked: slower it is held
constexpr double kCreeps = 1e-3;  // m/s: slower it does not give way to what pulls it

double speed_of(const Neighborhood& neighborhood, const FullContact& contact) {
  const auto velocity_of = [&](std::int32_t index) {
    if (index < 0) return Vec3(Vec3::Zero());
    const RigidState& state = neighborhood.bodies[std::size_t(index)].state;
    return Vec3(state.velocity + state.angular_velocity.cross(contact.point - state.position));
  };
  return (velocity_of(contact.first) - velocity_of(contact.second)).dot(contact.normal);
}

}  // namespace

void DrivenBodies::mark(Neighborhood& neighborhood, const Vec3& gravity, double dt) {
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
  mark_pulled(neighborhood, gravity);
}

// Across gravity alone: of what rests on statistical bodies ODE's velocity is that of its last substep, which
// still falls by a part of a step's gravity.
void DrivenBodies::mark_pulled(Neighborhood& neighborhood, const Vec3& gravity) {
  const std::span<FullNeighbor> bodies = neighborhood.bodies;
  const Vec3 down = gravity.isZero(0.0) ? Vec3(Vec3::Zero()) : Vec3(gravity.normalized());
  const auto velocity_across = [&](const FullNeighbor& body) {
    return Vec3(body.state.velocity - body.state.velocity.dot(down) * down);
  };
  pulls_.assign(bodies.size(), false);
  bool any = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const FullNeighbor& body = bodies[i];
    pulls_[i] = !body.asleep && velocity_across(body).dot(body.force) > kCreeps * body.force.norm();
    any |= pulls_[i];
  }
  if (!any) return;
  joined_.set_all_apart(bodies.size());
  for (const FullContact& contact : neighborhood.contacts)
    if (contact.row > 0 && contact.second >= 0) joined_.join(contact.first, contact.second);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (pulls_[i]) pulls_[std::size_t(joined_.root_of(std::int32_t(i)))] = true;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    FullNeighbor& body = bodies[i];
    body.driven |= !body.asleep && pulls_[std::size_t(joined_.root_of(std::int32_t(i)))] &&
                   velocity_across(body).norm() > kCreeps;
  }
}

}  // namespace lodestone
