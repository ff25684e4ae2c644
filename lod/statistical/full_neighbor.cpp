#include "lod/statistical/full_neighbor.h"

namespace lodestone {
namespace {

Vec3 angular_velocity_change(const FullNeighbor& body, const Vec3& angular_impulse) {
  const Quat& q = body.state.orientation;
  return q * (body.shape->inverse_inertia_per_mass * (q.conjugate() * angular_impulse)) / body.mass;
}

}  // namespace

// A hit changes the velocity before the first substep. Support is a force over the whole step: it then
// balances gravity in every substep, where a change of velocity would make the body hop, and bounce on what
// holds it up.
RigidState find_start(const FullNeighbor& neighbor, const Vec3& gravity, double dt, int substeps) {
  RigidState state = neighbor.state;
  state.velocity += neighbor.hit.linear / neighbor.mass;
  state.angular_velocity += angular_velocity_change(neighbor, neighbor.hit.angular);
  if (neighbor.touches_full || !neighbor.is_touched()) {
    state.position += neighbor.shift;
    return state;
  }
  // Who touches statistical bodies alone was moved by their solver: ODE is to bring it to where that left it.
  // Else overlaps are left that the next step undoes, and stacks of both kinds rock ever more.
  const double lasts = 0.5 * dt * (1.0 + 1.0 / substeps);  // s: what a force gives in a substep, on average
  const Vec3 accelerates = gravity * dt + (neighbor.force * dt + neighbor.push.linear) / neighbor.mass;
  state.position = neighbor.end.position - state.velocity * dt - accelerates * lasts;
  const Vec3 turn = state.angular_velocity * dt +
                    angular_velocity_change(neighbor, neighbor.torque * dt + neighbor.push.angular) * lasts;
  state.orientation = rotation_from_vector(-turn) * neighbor.end.orientation;
  return state;
}

}  // namespace lodestone
