#include "lod/statistical/full_neighbor.h"

#include <algorithm>
#include <vector>

namespace lodestone {
namespace {

Vec3 angular_velocity_change(const FullNeighbor& body, const Vec3& angular_impulse) {
  const Quat& q = body.state.orientation;
  return q * (body.shape->inverse_inertia_per_mass * (q.conjugate() * angular_impulse)) / body.mass;
}

// J: of two impulses, the kinetic energy of the first where both are the same, twice over.
double product(const FullNeighbor& body, const Impulse& a, const Impulse& b) {
  return a.linear.dot(b.linear) / body.mass + a.angular.dot(angular_velocity_change(body, b.angular));
}

// Over the fastest hit of a step, what the body's speed is changed by (its turning counted): a single one, by
// whatever mass, does it by 1 + e of its approach at most.
constexpr double kSqueezed = 2.0;

double square(double x) { return x * x; }

bool is_squeezed(const FullNeighbor& neighbor) {
  const Impulse struck = neighbor.hit + neighbor.backed_hit;
  return neighbor.fastest_hit > 0.0 &&
         product(neighbor, struck, struck) > square(kSqueezed * neighbor.fastest_hit) * neighbor.mass;
}

void answer_hit(FullNeighbor& neighbor) {
  Impulse &hit = neighbor.hit, &push = neighbor.push;
  if (is_squeezed(neighbor)) {
    hit = hit + neighbor.backed_hit + push + neighbor.backing, push = {};
    return;
  }
  push = push + neighbor.backed_hit;
  const double energy = product(neighbor, hit, hit);
  const double against = -product(neighbor, hit, push);
  if (!(against > 0.0)) return;
  const double share = std::min(1.0, against / energy);
  push.linear += share * hit.linear, push.angular += share * hit.angular;
  hit.linear *= 1.0 - share, hit.angular *= 1.0 - share;
}

}  // namespace

void answer_hits(std::span<FullNeighbor> neighbors, std::span<const FullExchange> exchanges) {
  struct Given {
    FullNeighbor* to;
    const Impulse* impulse;
  };
  std::vector<Given> given;  // by the squeezed to those that are not
  for (const FullExchange& exchange : exchanges) {
    FullNeighbor &first = neighbors[std::size_t(exchange.first)],
                 &second = neighbors[std::size_t(exchange.second)];
    const bool squeezed = is_squeezed(first), other_squeezed = is_squeezed(second);
    if (squeezed && !other_squeezed) given.push_back({&second, &exchange.on_second});
    if (other_squeezed && !squeezed) given.push_back({&first, &exchange.on_first});
    first.backing = first.backing + exchange.on_first;
    second.backing = second.backing + exchange.on_second;
  }
  for (FullNeighbor& neighbor : neighbors) answer_hit(neighbor);
  for (const auto& [to, impulse] : given) to->hit = to->hit + *impulse;
}

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
  const Vec3 pushed = angular_velocity_change(neighbor, neighbor.torque * dt + neighbor.push.angular) * lasts;
  const Quat before = state.orientation;
  state.orientation =
      rotation_from_vector(-(state.angular_velocity * dt + pushed)) * neighbor.end.orientation;
  // Of a thin rod's spin about its own axis that made one across it, which has hundreds of times the energy
  // (heaps of rods of two rungs: from 14 to 56 m/s in a step): then its spin is turned along with it.
  constexpr double kGain = 1.1;
  const Vec3 spin = before.conjugate() * state.angular_velocity;  // rad/s, in the body's axes
  const auto energy_of = [&](const Vec3& own) { return own.dot(neighbor.shape->inertia_per_mass * own); };
  if (energy_of(state.orientation.conjugate() * state.angular_velocity) > kGain * energy_of(spin)) {
    state.orientation =
        rotation_from_vector(-pushed) * neighbor.end.orientation * rotation_from_vector(-dt * spin);
    state.angular_velocity = state.orientation * spin;
  }
  return state;
}

}  // namespace lodestone
