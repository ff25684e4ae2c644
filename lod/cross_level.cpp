#include "lod/cross_level.h"

namespace lodestone {
namespace {

FullNeighbor neighbor_of(const Levels& levels, const FullLevel::Member& member) {
  const BodyRecord& record = levels.bodies[member.owner];
  FullNeighbor neighbor;
  neighbor.owner = member.owner;
  neighbor.shape = record.definition.shape.get();
  neighbor.mass = record.mass;
  neighbor.material = record.definition.material;
  neighbor.state = levels.full.world()->state(member.id);
  neighbor.force = record.force;
  neighbor.asleep = levels.full.world()->asleep(member.id);
  return neighbor;
}

double friction_between(const Levels& levels, const Neighborhood& neighborhood, const FullContact& contact) {
  const MaterialId first = neighborhood.bodies[contact.first].material;
  return levels.materials.law(first, contact.second < 0 ? 0 : neighborhood.bodies[contact.second].material).friction;
}

void gather_contacts(const Levels& levels, Neighborhood& neighborhood) {
  const auto index_of = [&](OdeBodyId body) { return levels.full.index_of(body); };
  for (const OdeContact& contact : levels.full.world()->contacts()) {
    const std::int32_t first = index_of(contact.first), second = contact.second ? index_of(contact.second) : -1;
    const bool gone = first < 0 || (contact.second && second < 0);
    if (gone) continue;
    FullContact& full = neighborhood.contacts.emplace_back(FullContact{first, second, contact.point, contact.normal, -contact.depth});
    full.friction = friction_between(levels, neighborhood, full);
  }
}

Vec3 angular_velocity_change(const FullNeighbor& body, const Vec3& angular_impulse) {
  const Quat& q = body.state.orientation;
  return q * (body.shape->inverse_inertia_per_mass * (q.conjugate() * angular_impulse)) / body.mass;
}

bool is_zero(const Impulse& impulse) { return impulse.linear.isZero(0.0) && impulse.angular.isZero(0.0); }

// A hit changes the velocity before the first substep. Support is a force over the whole step: it then balances gravity in every substep,
// where a change of velocity would make the body hop, and bounce on what holds it up.
void hand_over(OdeWorld& world, OdeBodyId body, const FullNeighbor& neighbor, double dt) {
  if (neighbor.asleep) return;
  if (world.asleep(body)) world.set_asleep(body, false);
  if (!is_zero(neighbor.push)) world.add_force(body, neighbor.push.linear / dt, neighbor.push.angular / dt);
  if (is_zero(neighbor.hit) && neighbor.shift.isZero(0.0)) return;
  RigidState state = neighbor.state;
  state.position += neighbor.shift;
  state.velocity += neighbor.hit.linear / neighbor.mass;
  state.angular_velocity += angular_velocity_change(neighbor, neighbor.hit.angular);
  world.set_state(body, state);
}

}  // namespace

void gather(const Levels& levels, Neighborhood& neighborhood) {
  neighborhood.bodies.clear();
  neighborhood.contacts.clear();
  for (const FullLevel::Member& member : levels.full.members()) neighborhood.bodies.push_back(neighbor_of(levels, member));
  if (!neighborhood.bodies.empty()) gather_contacts(levels, neighborhood);
}

void hand_over(Levels& levels, const Neighborhood& neighborhood, double dt) {
  for (std::size_t i = 0; i < neighborhood.bodies.size(); ++i)
    hand_over(*levels.full.world(), levels.full.members()[i].id, neighborhood.bodies[i], dt);
}

}  // namespace lodestone
