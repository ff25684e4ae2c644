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

// What presses on a body, over what is left of it and what backs it: of one that lies still, so many times
// its weight.
constexpr double kOverload = 20.0;

double square(double x) { return x * x; }

/// Whether `struck` is more than anything that struck it, or another, no faster than `fastest` (m/s) can do.
bool exceeds_hits(const FullNeighbor& neighbor, const Impulse& struck, double fastest) {
  return fastest > 0.0 && product(neighbor, struck, struck) > square(kSqueezed * fastest) * neighbor.mass;
}

/// Whether what presses on it, `by_full` by other full bodies, and what backs it all but cancel: ODE would
/// answer a steady force with what is no more the opposite once the body has moved by a little, and roll it
/// out from under its load. A motor goes on pressing.
bool all_but_cancel(const FullNeighbor& neighbor, const Impulse& by_full = {}) {
  if (neighbor.on_motor) return false;
  const Impulse pressed = neighbor.push + neighbor.backed_hit,
                left = neighbor.hit + pressed + neighbor.backing, load = pressed + by_full;
  return product(neighbor, load, load) > square(kOverload) * product(neighbor, left, left);
}

/// Of a step's full neighbours: those whose impulses are answered as the statistical level reckoned it, not
/// by ODE, and what they give to others.
class Burdened {
 public:
  void find(std::span<const FullNeighbor> neighbors, std::span<const FullExchange> exchanges) {
    burdens_.assign(neighbors.size(), {});
    given_.assign(neighbors.size(), {});
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
      const FullNeighbor& n = neighbors[i];
      if (exceeds_hits(n, n.hit + n.backed_hit, n.fastest_hit))
        burdens_[i] = {Burden::squeezed, n.fastest_hit};
      else if (all_but_cancel(n))
        burdens_[i].kind = Burden::overloaded;
    }
    for (bool more = !exchanges.empty(); more;) more = pass_on(neighbors, exchanges);
  }
  bool is_squeezed(std::size_t neighbor) const { return burdens_[neighbor].kind == Burden::squeezed; }
  bool is_overloaded(std::size_t neighbor) const { return burdens_[neighbor].kind == Burden::overloaded; }
  /// By them, to one that is not among them.
  const Impulse& hit_of(std::size_t neighbor) const { return given_[neighbor].hit; }
  const Impulse& push_of(std::size_t neighbor) const { return given_[neighbor].push; }

 private:
  struct Burden {
    enum Kind { none, squeezed, overloaded } kind = none;
    double fastest = 0.0;  ///< m/s, of the hits that squeeze it
  };
  struct Given {
    Impulse hit, push;
    double fastest = 0.0;  ///< m/s, of the hits that squeeze those who give it
  };
  /// What is lighter than what gives to it may be no better off. False: nobody more is found.
  bool pass_on(std::span<const FullNeighbor> neighbors, std::span<const FullExchange> exchanges) {
    std::ranges::fill(given_, Given{});
    for (const FullExchange& exchange : exchanges) {
      give(exchange.first, exchange.second, exchange.on_second);
      give(exchange.second, exchange.first, exchange.on_first);
    }
    bool more = false;
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
      const FullNeighbor& n = neighbors[i];
      const Given& given = given_[i];
      if (burdens_[i].kind == Burden::none && exceeds_hits(n, given.hit, given.fastest))
        burdens_[i] = {Burden::squeezed, given.fastest}, more = true;
      else if (burdens_[i].kind == Burden::none && !given.push.is_zero() && all_but_cancel(n, given.push))
        burdens_[i].kind = Burden::overloaded, more = true;
    }
    return more;
  }
  void give(std::int32_t from, std::int32_t to, const Impulse& impulse) {
    const Burden& burden = burdens_[std::size_t(from)];
    if (burden.kind == Burden::none || burdens_[std::size_t(to)].kind != Burden::none) return;
    Given& given = given_[std::size_t(to)];
    Impulse& sum = burden.kind == Burden::squeezed ? given.hit : given.push;
    sum = sum + impulse;
    given.fastest = std::max(given.fastest, burden.fastest);
  }

  std::vector<Burden> burdens_;  // by neighbour
  std::vector<Given> given_;     // by neighbour
};

void answer_hit(FullNeighbor& neighbor, const Burdened& burdened, std::size_t index) {
  Impulse &hit = neighbor.hit, &push = neighbor.push;
  if (burdened.is_squeezed(index)) {
    hit = hit + neighbor.backed_hit + push + neighbor.backing, push = {};
    return;
  }
  push = push + neighbor.backed_hit + burdened.push_of(index);
  if (burdened.is_overloaded(index)) push = push + neighbor.backing;
  const double energy = product(neighbor, hit, hit);
  if (const double against = -product(neighbor, hit, push); against > 0.0) {
    const double share = std::min(1.0, against / energy);
    push.linear += share * hit.linear, push.angular += share * hit.angular;
    hit.linear *= 1.0 - share, hit.angular *= 1.0 - share;
  }
  hit = hit + burdened.hit_of(index);
}

}  // namespace

void answer_hits(std::span<FullNeighbor> neighbors, std::span<const FullExchange> exchanges) {
  for (const FullExchange& exchange : exchanges) {
    FullNeighbor &first = neighbors[std::size_t(exchange.first)],
                 &second = neighbors[std::size_t(exchange.second)];
    first.backing = first.backing + exchange.on_first;
    second.backing = second.backing + exchange.on_second;
  }
  thread_local Burdened burdened;  // its memory serves every step
  burdened.find(neighbors, exchanges);
  for (std::size_t i = 0; i < neighbors.size(); ++i) answer_hit(neighbors[i], burdened, i);
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
