#include "lod/cross_level.h"

namespace lodestone {
namespace {

// A hit changes the velocity before the first substep. What is slower than this is support or a push: given as a force over the whole
// step, it balances gravity in every substep, and what the body rests on need not bounce it back.
constexpr double kHitSpeed = 0.5;  // m/s

Vec3 angular_velocity_change(const Shape& shape, double mass, const Quat& orientation, const Vec3& angular_impulse) {
  return orientation * (shape.inverse_inertia_per_mass * (orientation.conjugate() * angular_impulse)) / mass;
}

void push(OdeWorld& world, OdeBodyId body, const FullNeighbor& neighbor, double dt) {
  const Vec3 linear = neighbor.impulse / neighbor.mass;
  const Vec3 angular = angular_velocity_change(*neighbor.shape, neighbor.mass, neighbor.state.orientation, neighbor.angular_impulse);
  const double speed = linear.norm() + angular.norm() * neighbor.shape->radius;
  if (speed == 0.0) return;
  if (speed < kHitSpeed) {
    // Weight does not wake a sleeper.
    if (!world.asleep(body)) world.add_force(body, neighbor.impulse / dt, neighbor.angular_impulse / dt);
    return;
  }
  RigidState state = world.state(body);
  state.velocity += linear;
  state.angular_velocity += angular;
  world.set_state(body, state);
  world.set_asleep(body, false);
}

}  // namespace

void gather_neighbors(const Levels& levels, std::vector<FullNeighbor>& neighbors) {
  neighbors.clear();
  for (const FullLevel::Member& member : levels.full.members()) {
    const BodyRecord& record = levels.bodies[member.owner];
    neighbors.push_back({.shape = record.definition.shape.get(),
                         .mass = record.mass,
                         .material = record.definition.material,
                         .state = levels.full.world()->state(member.id),
                         .asleep = levels.full.world()->asleep(member.id)});
  }
}

void hand_over(Levels& levels, std::span<const FullNeighbor> neighbors, double dt) {
  for (std::size_t i = 0; i < neighbors.size(); ++i) push(*levels.full.world(), levels.full.members()[i].id, neighbors[i], dt);
}

}  // namespace lodestone
