// Boxes and what they touch, as a step of the statistical rungs has them.
#pragma once

#include "lod/contact/crowd.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::testing {

struct CrowdScene {
  explicit CrowdScene(const ContactLaw& law = {0.4, 0.5}) : materials(law) { world.materials = &materials; }

  Participant add(const std::shared_ptr<const Shape>& shape, double mass, const RigidState& state) {
    StatisticalBody& body = bodies.emplace_back();
    body.kind = kinds.take(StatisticalModel::support, shape, 0, nullptr);
    body.position = state.position, body.orientation = state.orientation, body.velocity = state.velocity;
    body.spin = spin_of(state.orientation, state.angular_velocity, *shape);
    body.mass = mass;
    body.owner = std::uint32_t(bodies.size());
    return Participant::statistical(bodies.size() - 1);
  }
  Participant add_full(const std::shared_ptr<const Shape>& shape, double mass, const RigidState& state) {
    FullNeighbor& full = neighbors.emplace_back();
    full.owner = 1000 + std::uint32_t(neighbors.size());
    full.shape = shape.get(), full.mass = mass, full.state = state;
    return Participant::full(neighbors.size() - 1);
  }
  ContactScene scene() { return {bodies, neighbors, kinds, world}; }

  /// Contacts of these pairs where they lie now, solved with the ground, and a step of that length.
  ContactTally step(double time, const std::vector<std::pair<Participant, Participant>>& pairs) {
    contacts.clear();
    for (const auto& [first, second] : pairs)
      if (const auto contact = find_hull_contact(scene().pair_body(first), scene().pair_body(second), 0.02))
        contacts.push_back({first, second, *contact});
    for (FullNeighbor& full : neighbors) full.hit = {}, full.push = {}, full.shift = Vec3::Zero();
    const CrowdTouch touch{contacts, {}, {}, faces, time};
    crowd.solve(scene(), touch);
    return crowd.move(scene(), touch);
  }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const StatisticalBody& body : bodies) sum += body.mass * body.velocity;
    return sum;
  }
  /// About the origin.
  Vec3 angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const StatisticalBody& body : bodies)
      sum += body.mass * (body.position.cross(body.velocity) + body.spin);
    return sum;
  }

  MaterialTable materials;
  Kinds kinds;
  StepWorld world{.gravity = Vec3::Zero()};
  std::vector<StatisticalBody> bodies;
  std::vector<FullNeighbor> neighbors;
  std::vector<CrowdContact> contacts;
  FacesBelow faces;
  Crowd crowd;
};

}  // namespace lodestone::testing
