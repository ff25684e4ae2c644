// The bodies that may take part in the contacts of a step, where they are in it now.
#pragma once

#include <span>

#include "lod/contact/pair_contacts.h"
#include "lod/contact/participant.h"
#include "lod/statistical/full_neighbor.h"
#include "lod/statistical/kinds.h"
#include "lod/statistical/step_world.h"

namespace lodestone {

struct ContactScene {
  std::span<StatisticalBody> bodies;
  std::span<FullNeighbor> neighbors;
  const Kinds& kinds;
  const StepWorld& world;

  StatisticalBody& body(Participant p) const { return bodies[p.index()]; }
  FullNeighbor& neighbor(Participant p) const { return neighbors[p.index()]; }
  const BodyKind& kind_of(const StatisticalBody& body) const { return kinds[body.kind]; }

  bool asleep(Participant p) const {
    return p.is_statistical() ? body(p).motion == Motion::asleep : neighbor(p).asleep;
  }
  const Shape& shape(Participant p) const {
    return p.is_statistical() ? *kind_of(body(p)).shape : *neighbor(p).shape;
  }
  MaterialId material(Participant p) const {
    return p.is_statistical() ? kind_of(body(p)).material : neighbor(p).material;
  }
  std::uint32_t owner(Participant p) const { return p.is_statistical() ? body(p).owner : neighbor(p).owner; }
  Vec3& position(Participant p) const {
    return p.is_statistical() ? body(p).position : neighbor(p).state.position;
  }
  const Quat& orientation(Participant p) const {
    return p.is_statistical() ? body(p).orientation : neighbor(p).state.orientation;
  }
  /// m/s, of the centre of mass; of one that sleeps: none.
  Vec3 velocity(Participant p) const {
    if (asleep(p)) return Vec3::Zero();
    return p.is_statistical() ? body(p).velocity : neighbor(p).state.velocity;
  }
  /// kg.
  double mass(Participant p) const { return p.is_statistical() ? body(p).mass : neighbor(p).mass; }
  const BodyProperties& properties(Participant p) const { return world.properties_of(owner(p)); }
  /// m/s², as it acts on the body.
  Vec3 gravity(Participant p) const { return properties(p).gravity ? world.gravity : Vec3(Vec3::Zero()); }
  /// m/s², of forces; those on bodies of `tables` are in their velocities, but for what bears them.
  Vec3 pushed(Participant p) const {
    if (p.is_full()) return neighbor(p).force / neighbor(p).mass;
    if (!p.is_statistical()) return Vec3::Zero();
    return world.force_on(std::int32_t(p.index())).acceleration + body(p).borne;
  }
  /// Whether any force or torque but gravity acts on it.
  bool is_forced(Participant p) const {
    if (p.is_full()) return !neighbor(p).force.isZero(0.0) || !neighbor(p).torque.isZero(0.0);
    return p.is_statistical() && !world.force_on(std::int32_t(p.index())).is_none();
  }
  Vec3 acceleration(Participant p) const { return gravity(p) + pushed(p); }
  PairBody pair_body(Participant p) const { return {&shape(p), position(p), orientation(p)}; }
  ContactLaw law(Participant a, Participant b) const {
    return world.materials->law(material(a), material(b));
  }
};

}  // namespace lodestone
